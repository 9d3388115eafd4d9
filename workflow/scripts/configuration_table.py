from fprc.stages.tabulate import tabulate_configuration
from fprc.stages.run import run_stage

run_stage(tabulate_configuration, snakemake)  # noqa: F821 (Snakemake provides it)
