from fprc.stages.preprocess import preprocess
from fprc.stages.run import run_stage

run_stage(preprocess, snakemake)  # noqa: F821 (Snakemake provides it)
