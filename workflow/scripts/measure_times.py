from fprc.stages.run import run_stage
from fprc.stages.timing import measure_times

run_stage(measure_times, snakemake)  # noqa: F821 (Snakemake provides it)
