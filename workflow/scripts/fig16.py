from fprc.stages.draw_tracking import draw_loops
from fprc.stages.figure import run_figure

run_figure(draw_loops, snakemake)  # noqa: F821 (Snakemake provides it)
