from fprc.stages.judge import measure_times
from fprc.stages.run import run_stage

run_stage(measure_times, snakemake)  # noqa: F821 (Snakemake provides it)
