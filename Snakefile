# `snakemake --cores 2 all` makes everything of the paper. The workflow is in workflow/, from where
# other workflows import it; the studies behind the paper are in workflow/studies.
include: "workflow/Snakefile"


# the default target of an included file does not count
workflow.default_target = "all"
