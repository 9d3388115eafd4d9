from fprc.stages.ensemble_claims import summarise_rigs
from fprc.stages.run import run_stage

run_stage(summarise_rigs, snakemake)  # noqa: F821 (Snakemake provides it)
