from fprc.experiments.sweeps import weigh
from fprc.stages.run import run_stage

run_stage(weigh, snakemake)  # noqa: F821 (Snakemake provides it)
