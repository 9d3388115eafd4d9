from fprc.apparatus.record import record_on_rig
from fprc.stages.run import run_stage

run_stage(record_on_rig, snakemake)  # noqa: F821 (Snakemake provides it)
