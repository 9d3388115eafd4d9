from fprc.stages.draw_tracking import draw_following
from fprc.stages.run import run_stage

run_stage(draw_following, snakemake)  # noqa: F821 (Snakemake provides it)
