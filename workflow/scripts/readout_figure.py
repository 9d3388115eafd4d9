from fprc.stages.draw_readout import draw_readout
from fprc.stages.figure import run_figure

run_figure(draw_readout, snakemake)  # noqa: F821 (Snakemake provides it)
