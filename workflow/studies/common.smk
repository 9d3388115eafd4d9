# Names that several rules of the studies share.

#: Rigs near print; the target `near_print` made them.
NEAR_PRINT = file_of_workflow("../../config/rigs/near_print.json")
# an unrelated folder may have docs/images too
IN_CHECKOUT = isinstance(RULES, os.PathLike) and os.path.samefile(
    os.path.join(RULES, "../.."), os.curdir
)


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
    rig, fitted = file["rig"], file["fitted"]["to"]
    return {
        "name": name,
        "rigs": name if name in SETS else "one",
        "every_model": name == CONFIGURED_WORLD,
        "first_seed": BEYOND["first_seed"],
        "seeds_per_rig": BEYOND["seeds_per_rig"] if name == "drawn" else 1,
        "fitted": SETS[name]["terms"] if name in SETS else fitted,
        "on_rig": on_rig(SETTINGS) | {"rig": rig},
        "drawn": pick(DRAWN, "seed", "angle_deg", "p_o_swing_kpa") if name == "drawn" else {},
        "free": FREE if name == "drawn" else {},
    }


def judging(judge, *models):
    """Return the params of a job that judges families of rigs.

    ``judge`` is the function below ``fprc.studies`` that does it, with ``models``.
    """
    judged_by = f"fprc.studies.{judge.rpartition('.')[0]}"
    stage_version = stage("studies.judge.judge_families", key="version")["version"]

    def version(wildcards):
        return f"{stage_version(wildcards)}-{fingerprint(judged_by, *map(class_module, models))}"

    return {"stage": "studies.judge.judge_families", "judge": judge, "version": version}


def world_of(wildcards):
    """Return the world of a job."""
    return family_named(wildcards.world)


def one_rig_each(wildcards):
    """Return the worlds that have one rig."""
    return [family_named(name) for name in (CONFIGURED_WORLD, *OTHER_RIGS)]


def units_of(wildcards):
    """Return the number of seeds or rigs of a world."""
    return BEYOND["rigs" if wildcards.world in SETS else "seeds"]


def units_of_tuning(wildcards):
    """Return the seeds or rigs of a world on which settings are chosen; they judge nothing else."""
    first = units_of(wildcards)
    return list(range(first, first + BEYOND["tuning"]["units"]))


def workers_over(units):
    """Return the param of the number of processes, for seeds or rigs that take seconds each."""

    def workers(wildcards, threads):
        number = units(wildcards) if callable(units) else units
        return max(1, min(threads, number // 4))

    return workers


def pictures_of_docs():
    """Return the figure of the results that each picture of the documentation copies."""
    figures = {}
    for params, files in ((known.params, known.input) for known in workflow.rules):
        if files.get("figures") and params.get("pictures"):
            figures |= dict(zip(params.pictures, map(str, files.figures)))
    return figures
