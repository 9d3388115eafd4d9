from fprc.stages.calibrate import calibrate
from fprc.stages.run import run_stage

run_stage(calibrate, snakemake)  # noqa: F821 (Snakemake provides it)
