from fprc.stages.draw_schematics import draw_actuator
from fprc.stages.figure import run_figure

run_figure(draw_actuator, snakemake)  # noqa: F821 (Snakemake provides it)
