from fprc.experiments.sweeps import sweep_settings
from fprc.stages.run import run_stage

run_stage(sweep_settings, snakemake)  # noqa: F821 (Snakemake provides it)
