from fprc.stages.draw_schematics import draw_apparatus
from fprc.stages.figure import run_figure

run_figure(draw_apparatus, snakemake)  # noqa: F821 (Snakemake provides it)
