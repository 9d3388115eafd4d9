from fprc.calibration.ensemble import measure_sensitivity
from fprc.stages.run import run_stage

run_stage(measure_sensitivity, snakemake)  # noqa: F821 (Snakemake provides it)
