from fprc.benchmark.cost import measure_scale
from fprc.stages.run import run_stage

run_stage(measure_scale, snakemake)  # noqa: F821 (Snakemake provides it)
