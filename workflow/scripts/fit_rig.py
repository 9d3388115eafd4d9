from fprc.calibration.fit import calibrate
from fprc.stages.run import run_stage

run_stage(calibrate, snakemake)  # noqa: F821 (Snakemake provides it)
