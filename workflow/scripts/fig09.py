from fprc.stages.draw import draw_weights
from fprc.stages.figure import run_figure

run_figure(draw_weights, snakemake)  # noqa: F821 (Snakemake provides it)
