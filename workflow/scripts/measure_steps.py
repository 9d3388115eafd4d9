from fprc.stages.run import run_stage
from fprc.stages.timing import measure_steps

run_stage(measure_steps, snakemake)  # noqa: F821 (Snakemake provides it)
