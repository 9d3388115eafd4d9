from fprc.stages.draw_tracking import draw_disturbance
from fprc.stages.figure import run_figure

run_figure(draw_disturbance, snakemake)  # noqa: F821 (Snakemake provides it)
