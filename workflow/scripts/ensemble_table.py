from fprc.stages.run import run_stage
from fprc.stages.tabulate import tabulate_ensemble

run_stage(tabulate_ensemble, snakemake)  # noqa: F821 (Snakemake provides it)
