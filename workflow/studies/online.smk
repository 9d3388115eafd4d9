# A model that learns while it runs, on families of rigs with a disturbed P_o.

#: First seed of the study; no other study has seen it.
FIRST_ONLINE = 1001


STUDY_RESULTS["judge_online"] = judgement_spec(
    "online/{world}",
    "online.judge.judge_online",
    *COMPETITORS,
    given={"near_print": NEAR_PRINT},
    family=lambda wildcards: (
        family_named(wildcards.world) | {"first_seed": FIRST_ONLINE, "seeds_per_rig": 1}
    ),
    units=list(range(BEYOND["slow"])),
    how={"tracking": SETTINGS["tracking"], "models": paper_models(SETTINGS)},
)

for table, tabulate in (
    ("verdicts", stage("studies.stages.online.tabulate_verdicts")),
    ("errors", stage("studies.stages.online.tabulate_errors")),
):
    STUDY_RESULTS[f"online_{table}"] = table_spec(
        f"online/{table}",
        {"families": expand(PATHS.below("online/{world}.json"), world=FAMILIES)},
        **tabulate,
    )

STUDY_RESULTS["online_figure"] = figure_spec(
    "online/figure",
    {"errors": PATHS.below("online/errors.csv")},
    **stage("studies.stages.online.draw_online"),
    names=FAMILIES[:3],
)


STUDY_TARGETS["online"] = [
    *expand(PATHS.below("online/{table}.md"), table=("verdicts", "errors")),
    PATHS.below("online/figure.pdf"),
    *STUDY_RESULTS["online_errors"].given.values(),
]
