from fprc.stages.run import run_stage
from fprc.stages.tabulate import tabulate_unavailable

run_stage(tabulate_unavailable, snakemake)  # noqa: F821 (Snakemake provides it)
