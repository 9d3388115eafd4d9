# Names that several rules of the studies share.

BEYOND = SETTINGS["beyond"]
CONFIGURED = SETTINGS["fitted"]["name"]
#: Rigs that can be named, beside that of the configuration.
OTHER_RIGS = {
    name: check({"rig": name}).model_dump(mode="json") for name in rig_files() if name != CONFIGURED
}
FAMILIES = [CONFIGURED, *OTHER_RIGS, "ensemble"]
#: Rigs that fit print, which `fprc calibrate --ensemble` found.
ENSEMBLE = "../../config/rigs/ensemble.json"
# relative and without links, so that neither moving the workflow with its results reruns anything,
# nor reaching it through a link
if isinstance(workflow.current_basedir, os.PathLike):
    FOLDER = os.path.relpath(os.path.realpath(workflow.current_basedir))
    ENSEMBLE = local(os.path.normpath(os.path.join(FOLDER, ENSEMBLE)))
else:  # a module from a git repository
    FOLDER, ENSEMBLE = "", workflow.source_path(ENSEMBLE)
#: What judges a unit of a family, below fprc.studies, with its arguments, and what differs from the
#: families of the configuration, by the folder of the results.
STUDIES = {
    "families": {
        "judge": "family.judge_tables",
        "how": {
            "tracking": SETTINGS["tracking"],
            "validation": validation(SETTINGS, models=paper_models(SETTINGS), seed=0),
        },
    },
    "beyond": {
        "judge": "contest.judge_models",
        "how": {
            # with their own number of starts of a clustering
            "models": paper_models(SETTINGS)
            | {"fprc": SETTINGS["models"]["fprc"] | pick(BEYOND, "restarts")},
            "tracking": SETTINGS["tracking"],
            "slow": BEYOND["slow"],
        },
    },
    "online": {
        "judge": "learning.judge_online",
        "how": {"tracking": SETTINGS["tracking"], "models": paper_models(SETTINGS)},
        "first_seed": 1001,  # no other study has seen it
        "units": min(BEYOND["units"], 10),  # fewer than eight decide nothing
    },
}
#: Tables of the models beyond the paper's in Markdown; the first two are CSV too.
PAGES_BEYOND = "claims models best memory worth".split()


def family_of(wildcards):
    """Return a family: its rigs, their seeds, and the settings of their simulation."""
    several = wildcards.family == "ensemble"
    rig = OTHER_RIGS.get(wildcards.family, SETTINGS)
    return {
        "name": wildcards.family,
        "rigs": "ensemble" if several else "one",
        "every_model": wildcards.family == CONFIGURED,
        "first_seed": STUDIES[wildcards.study].get("first_seed", BEYOND["first_seed"]),
        "fitted": SETTINGS["calibration"]["fit"] if several else rig["fitted"]["to"],
        "on_rig": on_rig(SETTINGS) | {"rig": rig["rig"]},
    }
