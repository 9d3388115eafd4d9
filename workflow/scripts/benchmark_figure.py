from fprc.stages.figure import run_figure
from fprc.stages.show_benchmark import draw_benchmark

run_figure(draw_benchmark, snakemake)  # noqa: F821 (Snakemake provides it)
