from fprc.stages.draw_tracking import draw_following
from fprc.stages.figure import run_figure

run_figure(draw_following, snakemake)  # noqa: F821 (Snakemake provides it)
