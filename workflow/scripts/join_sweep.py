from fprc.experiments.sweeps import join_sweep
from fprc.stages.run import run_stage

run_stage(join_sweep, snakemake)  # noqa: F821 (Snakemake provides it)
