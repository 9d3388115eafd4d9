from fprc.calibration.ensemble import judge_rigs
from fprc.stages.run import run_stage

run_stage(judge_rigs, snakemake)  # noqa: F821 (Snakemake provides it)
