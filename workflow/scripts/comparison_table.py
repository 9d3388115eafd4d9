from fprc.stages.run import run_stage
from fprc.stages.tabulate import tabulate_comparison

run_stage(tabulate_comparison, snakemake)  # noqa: F821 (Snakemake provides it)
