from fprc.stages.draw import draw_training
from fprc.stages.run import run_stage

run_stage(draw_training, snakemake)  # noqa: F821 (Snakemake provides it)
