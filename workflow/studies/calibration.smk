# What the numbers owe to each parameter of the rig. None of this is part of `all`.

BEYOND = SETTINGS["beyond"]
#: How the paper's models are judged, with any seed.
EVERY_SEED = judgement(SETTINGS, without="seed", models=paper_models(SETTINGS))


STUDY_RESULTS["measure_sensitivity"] = judgement_spec(
    "calibration/sensitivity",
    "families.sensitivity.judge_parameter",
    *MODELS,
    *COMPETITORS,
    runtime=240,
    family=lambda wildcards: family_named(SETTINGS["fitted"]["name"]),
    units=list(range(len(SETTINGS["calibration"]["free"]))),
    how={
        "paths": SETTINGS["calibration"]["free"],
        "steps": BEYOND["sensitivity_steps"],
        "seeds": SETTINGS["evaluation"]["replicate_seeds"][:2],
        "models": paper_models(SETTINGS),
        "tracking": SETTINGS["tracking"],
        "grids": pick(SETTINGS["grids"], "epsilon", "n_c") | pick(SETTINGS["calibration"], "taps"),
    },
)

STUDY_RESULTS["sensitivity_table"] = table_spec(
    "calibration/sensitivity",
    {"effects": PATHS.below("calibration/sensitivity.json")},
    **stage("studies.stages.sensitivity.tabulate_sensitivity"),
)

STUDY_RESULTS["sensitivity_figure"] = figure_spec(
    "calibration/sensitivity_figure",
    {"table": PATHS.below("calibration/sensitivity.csv")},
    **stage("studies.stages.sensitivity.draw_sensitivity"),
)


STUDY_TARGETS |= {
    "sensitivity": [
        PATHS.below("calibration/sensitivity.md"),
        PATHS.below("calibration/sensitivity_figure.pdf"),
        *STUDY_RESULTS["measure_sensitivity"].made.values(),
    ],
}
