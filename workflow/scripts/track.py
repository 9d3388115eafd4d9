from fprc.stages.run import run_stage
from fprc.stages.track import track

run_stage(track, snakemake)  # noqa: F821 (Snakemake provides it)
