from fprc.stages.run import run_stage
from fprc.stages.tabulate import tabulate_sensitivity

run_stage(tabulate_sensitivity, snakemake)  # noqa: F821 (Snakemake provides it)
