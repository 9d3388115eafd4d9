from fprc.stages.draw import draw_reservoir_hysteresis
from fprc.stages.run import run_stage

run_stage(draw_reservoir_hysteresis, snakemake)  # noqa: F821 (Snakemake provides it)
