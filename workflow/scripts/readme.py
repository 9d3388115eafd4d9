from fprc.stages.documents import update_readme
from fprc.stages.run import run_stage

run_stage(update_readme, snakemake)  # noqa: F821 (Snakemake provides it)
