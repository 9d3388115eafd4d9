# Functions that several rules share.

PATHS = PLAN.paths

#: Priorities: LONG starts long jobs early; ALONE is for jobs that need the whole machine. The
#: scheduler sums the priorities of jobs that start together, so ALONE exceeds LONG on every core.
LONG, ALONE = 1, workflow.cores + 1


RULES = workflow.current_basedir
# an unrelated folder may have docs/images too
IN_CHECKOUT = isinstance(RULES, os.PathLike) and os.path.samefile(
    os.path.join(RULES, "../.."), os.curdir
)


def own(name):
    """Return a file of this workflow, named from the folder of the rules.

    The path is relative, so that moving the workflow with its results reruns nothing.
    """
    if isinstance(RULES, os.PathLike):
        return local(os.path.relpath(os.path.join(RULES, name)))
    return workflow.source_path(name)  # a copy: the module comes from a git repository


def code_of(name, *models):
    """Return the fingerprint of the code of a stage and of the models that it runs."""
    modules = [class_module(model, SETTINGS["models"]) for model in models]
    return fingerprint("fprc.stages.run", module_of(name), *modules)


def stage(name, *models, key="code"):
    """Return the params of a stage: its name, and the fingerprint of its code and its models.

    ``key`` names the fingerprint: ``version`` if the stage's checkpoint depends on it.
    """
    # a function, so that a job's process reads the sources of its own stage only
    return {"stage": name, key: lambda wildcards: code_of(name, *models)}


def workers_for(cells):
    """Return the number of processes of a grid; starting one takes as long as 20 cells."""
    # leave half of the cores to other jobs, unless --max-threads limits each job
    limit = workflow.resource_settings.max_threads or workflow.cores // 2
    return max(1, min(limit, cells // 20))


def workers_of(wildcards):
    """Return the number of processes of a grid, or of a chunk of it."""
    sizes = [len(SETTINGS["grids"][name]) for name in GRID_SETTINGS[wildcards.grid]]
    return workers_for(prod(sizes) * len(GRID_MODELS[wildcards.grid]) // GRID_CHUNKS)


def memory_of(wildcards, threads):
    """Return the MB of a pool of processes: each holds the logs and one model."""
    return 1000 * (1 + threads)


def drawn(stem, statistics=False, **report_of):
    """Return the files of a figure: two pictures, their provenance, and the numbers drawn."""
    png = report(f"{stem}.png", **report_of) if report_of else f"{stem}.png"
    files = {"pdf": f"{stem}.pdf", "png": png, "sidecar": f"{stem}.json"}
    return files | ({"csv": f"{stem}.csv"} if statistics else {})


def figure(number, statistics=False):
    """Return the files of one of the paper's figures."""
    result = BY_NAME[f"fig{number}"]
    return drawn(
        PATHS.below(result.files[0].removesuffix(".pdf")),
        statistics,
        caption=f"../report/fig{number:02}.rst",
        category=result.chapter,
        labels={"figure": result.title, "data": PLAN.origin},
    )


def refused(name):
    """Return an input function that ends the workflow with the reason."""

    def input_of(wildcards):
        raise WorkflowError(refusal(name, PLAN.unavailable))

    return input_of


def unchanged(name):
    """Return a result that is no input of its job, or end the workflow if it was changed."""
    path = placed(PATHS.below(name))
    refuse_changed(RESULTS, [path])
    return path


def made_by_rules():
    """Return regular expressions of all files of the rules: outputs, logs, checkpoints."""
    checkpoints = [rule.params.get("checkpoint") for rule in workflow.rules]
    kept = [
        rf"{regex_from_filepattern(path).removesuffix('$')}(\.\d+)?(\.old)?"
        for path in checkpoints
        if path
    ]
    files = [path for rule in workflow.rules for path in (*rule.output, *rule.log)]
    return sorted({path.regex().pattern for path in files}.union(kept))


def pictures_of_docs():
    """Return the figure of the results that each picture of the documentation copies."""
    figures = {}
    for params, files in ((each.params, each.input) for each in workflow.rules):
        if params.get("picture"):
            figures[params.picture] = str(files.figure)
        if files.get("figures") and params.get("pictures"):
            figures |= dict(zip(params.pictures, map(str, files.figures)))
    return figures


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


def world_named(name):
    """Return a world: its rigs, their seeds, and the settings of their simulation."""
    file = named_rig(name) if name in OTHER_RIGS else pick(SETTINGS, "rig", "fitted")
    rig, fitted = file["rig"], file["fitted"]["to"]
    return {
        "name": name,
        "rigs": name if name in SETS_OF_RIGS else "one",
        "every_model": name == OWN_WORLD or name in FITTED_RIGS,
        "first_seed": BEYOND["first_seed"],
        "seeds_per_rig": BEYOND["seeds_per_rig"] if name == "drawn" else 1,
        "fitted": {"posterior": ["tables"], "drawn": []}.get(name, fitted),
        "on_rig": on_rig(SETTINGS) | {"rig": rig},
        "ensemble": DRAWN if name == "drawn" else {},
        "free": FREE if name == "drawn" else {},
    }


def world_of(wildcards):
    """Return the world of a job."""
    return world_named(wildcards.world)


def units_of(wildcards):
    """Return the number of seeds or rigs of a world."""
    return BEYOND["rigs" if wildcards.world in SETS_OF_RIGS else "seeds"]


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
