from fprc.stages.judge import measure_times_over_n_c
from fprc.stages.run import run_stage

run_stage(measure_times_over_n_c, snakemake)  # noqa: F821 (Snakemake provides it)
