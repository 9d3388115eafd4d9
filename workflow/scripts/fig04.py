from fprc.stages.draw import draw_actuator_hysteresis
from fprc.stages.run import run_stage

run_stage(draw_actuator_hysteresis, snakemake)  # noqa: F821 (Snakemake provides it)
