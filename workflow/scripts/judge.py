from fprc.experiments.comparison import judge
from fprc.stages.run import run_stage

run_stage(judge, snakemake)  # noqa: F821 (Snakemake provides it)
