from fprc.stages.run import run_stage
from fprc.stages.sweep import sweep_settings

run_stage(sweep_settings, snakemake)  # noqa: F821 (Snakemake provides it)
