from fprc.stages.claims import check_verdicts
from fprc.stages.run import run_stage

run_stage(check_verdicts, snakemake)  # noqa: F821 (Snakemake provides it)
