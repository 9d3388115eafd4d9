from fprc.experiments.hysteresis import record
from fprc.stages.run import run_stage

run_stage(record, snakemake)  # noqa: F821 (Snakemake provides it)
