from fprc.stages.run import run_stage
from fprc.stages.tabulate import tabulate_tracking

run_stage(tabulate_tracking, snakemake)  # noqa: F821 (Snakemake provides it)
