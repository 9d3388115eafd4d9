from fprc.experiments.tracking import identify_gain_from_logs
from fprc.stages.run import run_stage

run_stage(identify_gain_from_logs, snakemake)  # noqa: F821 (Snakemake provides it)
