from fprc.stages.run import run_stage
from fprc.stages.track import identify_gain

run_stage(identify_gain, snakemake)  # noqa: F821 (Snakemake provides it)
