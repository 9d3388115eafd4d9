from fprc.stages.draw import draw_settings
from fprc.stages.figure import run_figure

run_figure(draw_settings, snakemake)  # noqa: F821 (Snakemake provides it)
