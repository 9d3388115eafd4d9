from fprc.experiments.readout import measure_readout
from fprc.stages.run import run_stage

run_stage(measure_readout, snakemake)  # noqa: F821 (Snakemake provides it)
