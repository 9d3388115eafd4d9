from fprc.stages.run import run_stage
from fprc.stages.scale import update_scaling_page

run_stage(update_scaling_page, snakemake)  # noqa: F821 (Snakemake provides it)
