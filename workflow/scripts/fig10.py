from fprc.stages.draw import draw_settings
from fprc.stages.run import run_stage

run_stage(draw_settings, snakemake)  # noqa: F821 (Snakemake provides it)
