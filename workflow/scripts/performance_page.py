from fprc.stages.run import run_stage
from fprc.stages.show_benchmark import update_performance

run_stage(update_performance, snakemake)  # noqa: F821 (Snakemake provides it)
