from fprc.stages.draw import draw_actuator_hysteresis
from fprc.stages.figure import run_figure

run_figure(draw_actuator_hysteresis, snakemake)  # noqa: F821 (Snakemake provides it)
