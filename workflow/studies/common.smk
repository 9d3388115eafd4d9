# Names that several rules of the studies share.

BEYOND = SETTINGS["beyond"]
#: Rigs that fit print, which `fprc calibrate --ensemble` found.
ENSEMBLE = file_of_workflow("../../config/rigs/ensemble.json")
# an unrelated folder may have docs/images too
IN_CHECKOUT = isinstance(RULES, os.PathLike) and os.path.samefile(
    os.path.join(RULES, "../.."), os.curdir
)
#: Files of each target; the Snakefile has their rules.
STUDY_TARGETS = {}


@cache
def named_rig(name):
    """Return the sections ``rig`` and ``fitted`` of a rig's file."""
    return from_files([OTHER_RIGS[name]]).model_dump(mode="json", include={"rig", "fitted"})


def on_rigs(part):
    """Return the reports of the further seeds: those of this rig, then those of other fitted ones."""
    seeds = SETTINGS["evaluation"]["replicate_seeds"]
    return PLAN.replicates(part) + [
        PATHS.below(f"rigs/{rig}/{part}_{seed}.json") for rig in FITTED_RIGS for seed in seeds
    ]


def family_named(name):
    """Return a family: its rigs, their seeds, and the settings of their simulation."""
    file = named_rig(name) if name in OTHER_RIGS else pick(SETTINGS, "rig", "fitted")
    return {
        "name": name,
        "rigs": name if name in SETS else "one",
        "every_model": name == CONFIGURED_FAMILY,
        "first_seed": BEYOND["first_seed"],
        "fitted": SETS.get(name, file["fitted"]["to"]),
        "on_rig": on_rig(SETTINGS) | {"rig": file["rig"]},
    }


def memory_of(wildcards, threads):
    """Return the MB of a pool of processes: each holds the logs and one model."""
    return 1000 * (1 + threads)


def studies_with(*models):
    """Return the digest of the code that computes a study with models."""
    return code_that_computes(*models, also=["studies"])


def checkpoint_of(name):
    """Return the file in which a job keeps what it has finished."""
    return with_prefix(PATHS.below(f"{name}.partial.jsonl"))


def by_block(folder, tables):
    """Return tables in a folder by their blocks in the documentation, which are named after both."""
    return {f"{folder}_{table}": PATHS.below(f"{folder}/{table}.md") for table in tables}
