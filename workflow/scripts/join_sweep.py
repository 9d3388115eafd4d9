from fprc.stages.run import run_stage
from fprc.stages.sweep import join_sweep

run_stage(join_sweep, snakemake)  # noqa: F821 (Snakemake provides it)
