from fprc.stages.run import run_stage
from fprc.stages.tabulate import tabulate_tracking_seeds

run_stage(tabulate_tracking_seeds, snakemake)  # noqa: F821 (Snakemake provides it)
