from fprc.stages.run import run_stage

run_stage(snakemake)  # noqa: F821 (Snakemake provides it)
