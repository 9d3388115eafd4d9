from fprc.stages.draw import draw_taps
from fprc.stages.figure import run_figure

run_figure(draw_taps, snakemake)  # noqa: F821 (Snakemake provides it)
