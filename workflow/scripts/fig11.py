from fprc.stages.draw import draw_taps
from fprc.stages.run import run_stage

run_stage(draw_taps, snakemake)  # noqa: F821 (Snakemake provides it)
