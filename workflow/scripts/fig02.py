from fprc.stages.draw_schematics import draw_reservoir
from fprc.stages.figure import run_figure

run_figure(draw_reservoir, snakemake)  # noqa: F821 (Snakemake provides it)
