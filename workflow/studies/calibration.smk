# What the numbers owe to each parameter of the rig and to its stop. None of this is part of `all`.

DRAWN, BEYOND = SETTINGS["drawn"], SETTINGS["beyond"]
#: How the paper's models are judged, with any seed.
EVERY_SEED = judgement(SETTINGS, without="seed", models=paper_models(SETTINGS))


STUDY_RESULTS["measure_sensitivity"] = judgement_spec(
    "calibration/sensitivity",
    "Sensitivity of all numbers to each parameter of the rig",
    "families.sensitivity.judge_parameter",
    *MODELS,
    *COMPETITORS,
    runtime=240,
    families=lambda wildcards: [family_named(SETTINGS["fitted"]["name"])],
    units=list(range(len(SETTINGS["calibration"]["free"]))),
    how={
        "paths": SETTINGS["calibration"]["free"],
        "steps": DRAWN["sensitivity_steps"],
        "seeds": SETTINGS["evaluation"]["replicate_seeds"][:2],
        "models": paper_models(SETTINGS),
        "tracking": SETTINGS["tracking"],
        "surrogate": pick(SETTINGS["calibration"], "stride", "esn_nodes", "restarts", "taps"),
        "grids": pick(SETTINGS["grids"], "epsilon", "n_c"),
    },
)

STUDY_RESULTS["sensitivity_table"] = table_spec(
    "calibration/sensitivity",
    "Sensitivity",
    {"effects": PATHS.below("calibration/sensitivity.json")},
    **stage("studies.sensitivity.tabulate_sensitivity"),
)

STUDY_RESULTS["sensitivity_figure"] = figure_spec(
    "calibration/sensitivity_figure",
    "Sensitivity",
    {"table": PATHS.below("calibration/sensitivity.csv")},
    **stage("studies.sensitivity.draw_sensitivity"),
)

#: What is changed of the drift, by the words that follow the name of the rig.
DRIFTS = {"": {}, ", no drift": {"sigma_kpa": 0.0}, ", drift over 10 s": {"time_s": 10.0}}


def rigs_with_other_drift(wildcards):
    """Return the rig of the configuration and dry as families, each also with another drift."""
    found = []
    for name in dict.fromkeys([SETTINGS["fitted"]["name"], "dry"]):
        family = family_named(name)
        settings, rig = family["on_rig"], family["on_rig"]["rig"]
        for words, drift in DRIFTS.items():
            changed = settings | {"rig": rig | {"drift": rig["drift"] | drift}}
            # units are the seeds
            found.append(family | {"name": name + words, "on_rig": changed, "first_seed": 0})
    return found


STUDY_RESULTS["measure_stop"] = judgement_spec(
    "calibration/stop",
    "Errors at the stop of the actuator",
    "families.stop.judge_stop",
    *MODELS,
    families=rigs_with_other_drift,
    units=SETTINGS["evaluation"]["replicate_seeds"],
    how={"judgement": EVERY_SEED},
)

STUDY_RESULTS["stop_table"] = table_spec(
    "calibration/stop",
    "Errors at the stop",
    {"judged": PATHS.below("calibration/stop.json")},
    **stage("studies.sensitivity.tabulate_stop"),
)


STUDY_TARGETS |= {
    "sensitivity": [
        PATHS.below("calibration/sensitivity.md"),
        PATHS.below("calibration/sensitivity_figure.pdf"),
        PATHS.below("calibration/stop.md"),
        *STUDY_RESULTS["measure_sensitivity"].made.values(),
    ],
}
