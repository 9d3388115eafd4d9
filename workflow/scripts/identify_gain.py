from fprc.experiments.tracking import identify_gain
from fprc.stages.run import run_stage

run_stage(identify_gain, snakemake)  # noqa: F821 (Snakemake provides it)
