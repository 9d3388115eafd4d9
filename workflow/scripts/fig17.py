from fprc.stages.draw_tracking import draw_disturbance
from fprc.stages.run import run_stage

run_stage(draw_disturbance, snakemake)  # noqa: F821 (Snakemake provides it)
