from fprc.stages.draw import draw_training
from fprc.stages.figure import run_figure

run_figure(draw_training, snakemake)  # noqa: F821 (Snakemake provides it)
