from fprc.experiments.reservoir import add_reservoir
from fprc.stages.run import run_stage

run_stage(add_reservoir, snakemake)  # noqa: F821 (Snakemake provides it)
