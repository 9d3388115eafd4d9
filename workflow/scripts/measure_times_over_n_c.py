from fprc.stages.run import run_stage
from fprc.stages.timing import measure_times_over_n_c

run_stage(measure_times_over_n_c, snakemake)  # noqa: F821 (Snakemake provides it)
