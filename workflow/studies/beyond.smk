# Beyond the paper: competitors of its models, on several families of simulated rigs.

#: Settings of the tuned models; docs/beyond-details.md says how they were chosen.
TUNED = file_of_workflow("../../config/tuned.yaml")
#: Families: the rig of the configuration, every other named rig, and the sets of rigs.
CONFIGURED_FAMILY = SETTINGS["fitted"]["name"]
FAMILIES = [CONFIGURED_FAMILY, *OTHER_RIGS, *SETS]
#: Names of the tables in Markdown.
PAGES_BEYOND = "claims models offsets beside fitted details leaderboard".split()
#: Settings of the models and of their competitors, with their own number of starts of a clustering.
CONTESTANTS = paper_models(SETTINGS) | {
    "fprc": SETTINGS["models"]["fprc"] | {"restarts": BEYOND["restarts"]}
}
CONTEST = {
    "models": CONTESTANTS,
    "tracking": SETTINGS["tracking"],
    "shifts_kpa": BEYOND["shifts_kpa"],
}


wildcard_constraints:
    world="|".join(FAMILIES),


STUDY_RESULTS["beyond_world"] = judgement_spec(
    "beyond/{world}",
    "beyond.contest.judge_models",
    *COMPETITORS,
    given={"near_print": NEAR_PRINT, "tuned": TUNED},
    family=lambda wildcards: family_named(wildcards.world),
    units=list(range(BEYOND["units"])),
    how={"contest": CONTEST, "slow": BEYOND["slow"]},
)

STUDY_RESULTS["beyond_tables"] = result_spec(
    "beyond/claims",
    "tables",
    {"families": expand(PATHS.below("beyond/{world}.json"), world=FAMILIES)},
    {
        **{name: PATHS.below(f"beyond/{name}.csv") for name in PAGES_BEYOND[:3]},
        "pages": expand(PATHS.below("beyond/{page}.md"), page=PAGES_BEYOND),
    },
    **stage("studies.stages.beyond.tabulate_beyond"),
    family=CONFIGURED_FAMILY,
)

STUDY_RESULTS["draw_pairs"] = figure_spec(
    "beyond/figure_pairs",
    {"claims": PATHS.below("beyond/claims.csv")},
    **stage("studies.stages.beyond.draw_pairs"),
)


STUDY_TARGETS |= {
    "beyond": [
        PATHS.below("beyond/claims.md"),
        PATHS.below("beyond/figure_pairs.pdf"),
        *STUDY_RESULTS["beyond_tables"].given.values(),
    ],
}
