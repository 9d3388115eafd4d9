# `snakemake --cores 2 all` makes everything of the paper. The workflow is in workflow/, from where
# other workflows import it; the studies behind the paper are in workflow/studies.
from snakemake.logging import logger


include: "workflow/Snakefile"


# the default target of an included file does not count
workflow.default_target = "all"


#: Targets of workflow/studies/Snakefile. Its rules are not read here: no target of the paper needs
#: them.
STUDIES = (
    "studies",
    "calibrate",
    "sensitivity",
    "targets",
    "families",
    "beyond",
    "tuned",
    "online",
    "check",
    "readme",
    "calibration_page",
    "beyond_page",
    "drift_page",
)

for target in STUDIES:
    if target not in PLAN.unavailable:

        rule:
            name:
                target
            input:
                refused(
                    f"{target}: a target of the studies; run `snakemake --cores 2 --snakefile"
                    f" {file_of_workflow('../studies/Snakefile')} {target}`"
                ),
            localrule: True


KNOWN_TARGETS.update(STUDIES)


onstart:
    if not workflow.dag_settings.targets:
        logger.info(
            f"No target is given: making everything of the paper, from {PLAN.origin}, into {RESULTS}. "
            "A first build takes minutes; what is finished is kept."
        )
