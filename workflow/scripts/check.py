from fprc.stages.check import check_results
from fprc.stages.run import run_stage

run_stage(check_results, snakemake)  # noqa: F821 (Snakemake provides it)
