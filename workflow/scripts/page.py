from fprc.stages.report import write_report
from fprc.stages.run import run_stage

run_stage(write_report, snakemake)  # noqa: F821 (Snakemake provides it)
