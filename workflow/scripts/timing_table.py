from fprc.stages.run import run_stage
from fprc.stages.tabulate import tabulate_times

run_stage(tabulate_times, snakemake)  # noqa: F821 (Snakemake provides it)
