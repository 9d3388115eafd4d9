# Beyond the paper: competitors of its models, on several families of simulated rigs.

#: Settings of the tuned models; docs/beyond-details.md says how they were chosen.
TUNED = file_of_workflow("../../config/tuned.yaml")
#: Families: the rig of the configuration, every other named rig, and the sets of rigs.
CONFIGURED_FAMILY = SETTINGS["fitted"]["name"]
FAMILIES = [CONFIGURED_FAMILY, *OTHER_RIGS, *SETS]
#: Tables of the figures.
FIGURES_BEYOND = {"pairs": "claims", "offsets": "offsets"}
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
    **stage("studies.show_beyond.tabulate_beyond"),
    family=CONFIGURED_FAMILY,
)

for figure, table in FIGURES_BEYOND.items():
    STUDY_RESULTS[f"draw_{figure}"] = figure_spec(
        f"beyond/figure_{figure}",
        {"table": PATHS.below(f"beyond/{table}.csv")},
        **stage("studies.show_beyond.draw_beyond"),
        figure=figure,
        family=CONFIGURED_FAMILY,
    )


STUDY_TARGETS |= {
    "beyond": [
        PATHS.below("beyond/claims.md"),
        *expand(PATHS.below("beyond/figure_{name}.pdf"), name=FIGURES_BEYOND),
        *STUDY_RESULTS["beyond_tables"].given.values(),
    ],
}
