from fprc.stages.draw_tracking import draw_loops
from fprc.stages.run import run_stage

run_stage(draw_loops, snakemake)  # noqa: F821 (Snakemake provides it)
