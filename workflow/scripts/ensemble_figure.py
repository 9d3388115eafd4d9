from fprc.stages.draw_ensemble import draw_ensemble
from fprc.stages.figure import run_figure

run_figure(draw_ensemble, snakemake)  # noqa: F821 (Snakemake provides it)
