from fprc.stages.replicate import replicate_sweeps
from fprc.stages.run import run_stage

run_stage(replicate_sweeps, snakemake)  # noqa: F821 (Snakemake provides it)
