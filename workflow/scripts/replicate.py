from fprc.stages.replicate import replicate
from fprc.stages.run import run_stage

run_stage(replicate, snakemake)  # noqa: F821 (Snakemake provides it)
