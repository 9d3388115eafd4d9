from fprc.stages.run import run_stage
from fprc.stages.show_benchmark import tabulate_rules

run_stage(tabulate_rules, snakemake)  # noqa: F821 (Snakemake provides it)
