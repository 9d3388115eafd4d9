from fprc.stages.run import run_stage
from fprc.stages.tabulate import tabulate_steps

run_stage(tabulate_steps, snakemake)  # noqa: F821 (Snakemake provides it)
