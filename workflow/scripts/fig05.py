from fprc.stages.draw import draw_reservoir_hysteresis
from fprc.stages.figure import run_figure

run_figure(draw_reservoir_hysteresis, snakemake)  # noqa: F821 (Snakemake provides it)
