from fprc.stages.claims import write_ledger
from fprc.stages.run import run_stage

run_stage(write_ledger, snakemake)  # noqa: F821 (Snakemake provides it)
