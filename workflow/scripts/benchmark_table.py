from fprc.stages.run import run_stage
from fprc.stages.show_benchmark import tabulate_benchmark

run_stage(tabulate_benchmark, snakemake)  # noqa: F821 (Snakemake provides it)
