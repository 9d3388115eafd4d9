from fprc.stages.replicate import replicate_control
from fprc.stages.run import run_stage

run_stage(replicate_control, snakemake)  # noqa: F821 (Snakemake provides it)
