from fprc.stages.run import run_stage
from fprc.stages.scale import measure_scale

run_stage(measure_scale, snakemake)  # noqa: F821 (Snakemake provides it)
