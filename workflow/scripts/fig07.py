from fprc.stages.draw_schematics import draw_fprc_system
from fprc.stages.figure import run_figure

run_figure(draw_fprc_system, snakemake)  # noqa: F821 (Snakemake provides it)
