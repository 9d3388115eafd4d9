from fprc.benchmark.cost import update_scaling_page
from fprc.stages.run import run_stage

run_stage(update_scaling_page, snakemake)  # noqa: F821 (Snakemake provides it)
