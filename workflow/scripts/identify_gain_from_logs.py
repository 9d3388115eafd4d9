from fprc.stages.run import run_stage
from fprc.stages.track import identify_gain_from_logs

run_stage(identify_gain_from_logs, snakemake)  # noqa: F821 (Snakemake provides it)
