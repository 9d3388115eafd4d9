from fprc.experiments.tracking import track
from fprc.stages.run import run_stage

run_stage(track, snakemake)  # noqa: F821 (Snakemake provides it)
