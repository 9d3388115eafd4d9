from fprc.benchmark.comparisons import measure_benchmark
from fprc.stages.run import run_stage

run_stage(measure_benchmark, snakemake)  # noqa: F821 (Snakemake provides it)
