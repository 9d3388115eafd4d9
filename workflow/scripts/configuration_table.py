from fprc.stages.run import run_stage
from fprc.stages.tabulate import tabulate_configuration

run_stage(tabulate_configuration, snakemake)  # noqa: F821 (Snakemake provides it)
