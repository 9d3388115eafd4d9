from fprc.stages.tabulate import tabulate_times
from fprc.stages.run import run_stage

run_stage(tabulate_times, snakemake)  # noqa: F821 (Snakemake provides it)
