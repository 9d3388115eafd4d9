from fprc.stages.gains import read_gains
from fprc.stages.run import run_stage

run_stage(read_gains, snakemake)  # noqa: F821 (Snakemake provides it)
