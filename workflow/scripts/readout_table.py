from fprc.stages.run import run_stage
from fprc.stages.tabulate import tabulate_readout

run_stage(tabulate_readout, snakemake)  # noqa: F821 (Snakemake provides it)
