from fprc.stages.documents import update_calibration_page
from fprc.stages.run import run_stage

run_stage(update_calibration_page, snakemake)  # noqa: F821 (Snakemake provides it)
