from fprc.stages.draw import draw_weights
from fprc.stages.run import run_stage

run_stage(draw_weights, snakemake)  # noqa: F821 (Snakemake provides it)
