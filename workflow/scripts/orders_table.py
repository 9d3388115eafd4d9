from fprc.stages.run import run_stage
from fprc.stages.tabulate import tabulate_orders

run_stage(tabulate_orders, snakemake)  # noqa: F821 (Snakemake provides it)
