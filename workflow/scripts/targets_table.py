from fprc.stages.run import run_stage
from fprc.stages.tabulate import tabulate_targets

run_stage(tabulate_targets, snakemake)  # noqa: F821 (Snakemake provides it)
