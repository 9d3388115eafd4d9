# Names that several rules of the studies share.

BEYOND = SETTINGS["beyond"]
#: How the paper's models are judged, with any seed.
EVERY_SEED = judgement(SETTINGS, without="seed", models=paper_models(SETTINGS))

#: Rigs near print; decision 16 says how they were found.
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
    calibration = SETTINGS["calibration"]
    drawn = {
        "seeds_per_rig": BEYOND["seeds_per_rig"],
        "free": {"paths": calibration["free"], "ranges": calibration["ranges"]},
    }
    file = named_rig(name) if name in OTHER_RIGS else pick(SETTINGS, "rig", "fitted")
    return {
        "name": name,
        "rigs": name if name in SETS else "one",
        "every_model": name == CONFIGURED_FAMILY,
        "first_seed": BEYOND["first_seed"],
        "seeds_per_rig": 1,
        "fitted": SETS.get(name, file["fitted"]["to"]),
        "on_rig": on_rig(SETTINGS) | {"rig": file["rig"]},
        **(drawn if name == "drawn" else {}),
    }


#: Results of the studies by their rules, and the files of each target; rows.smk has the rules.
STUDY_RESULTS, STUDY_TARGETS = {}, {}


def memory_of(wildcards, threads):
    """Return the MB of a pool of processes: each holds the logs and one model."""
    return 1000 * (1 + threads)


def judgement_spec(stem, judge, *models, given=None, runtime=120, **params):
    """Return what is peculiar to a job that judges a family of rigs, with a checkpoint.

    Parameters
    ----------
    stem : str
        Its file below the results, without suffix.
    judge : str
        Function below ``fprc.studies`` that does it, with ``models``.
    given : dict
        Its inputs, if it has any.
    runtime : int
        Minutes.
    **params
        ``family``, ``units`` and ``how``, see ``fprc.studies.stages.judge``.
    """
    judged_by = f"fprc.studies.{judge.rpartition('.')[0]}"
    of_stage = stage("studies.stages.judge.judge_family")

    # the checkpoint depends on it too
    def version(wildcards):
        own = fingerprint(judged_by, *map(class_module, models))
        return f"{of_stage['code'](wildcards)}-{own}"

    params |= {
        "stage": of_stage["stage"],
        "judge": judge,
        "workers": lambda wildcards, threads: threads,
        "checkpoint": with_prefix(PATHS.below(f"{stem}.partial.jsonl")),
    }
    return result_spec(
        stem,
        "measurements",
        given or {},
        {"judged": PATHS.below(f"{stem}.json")},
        threads=workflow.cores,
        resources={"mem_mb": memory_of, "runtime": runtime},
        **params | {"version": version},
    )


def by_block(folder, tables):
    """Return tables in a folder by their blocks in the documentation, which are named after both."""
    return {f"{folder}_{table}": PATHS.below(f"{folder}/{table}.md") for table in tables}
