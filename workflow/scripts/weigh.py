from fprc.stages.run import run_stage
from fprc.stages.sweep import weigh

run_stage(weigh, snakemake)  # noqa: F821 (Snakemake provides it)
