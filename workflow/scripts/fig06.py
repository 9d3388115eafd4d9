from fprc.stages.draw_schematics import draw_esn_system
from fprc.stages.figure import run_figure

run_figure(draw_esn_system, snakemake)  # noqa: F821 (Snakemake provides it)
