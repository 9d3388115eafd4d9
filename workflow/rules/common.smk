# What several rules share.
from math import prod

from snakemake.io import regex_from_filepattern

try:
    # a job reads this file again; by then the main process has looked at the logs, from a safe place
    THERE = headers(
        [f"{RAW}/{name}.h5" for name in Plan(SETTINGS, {}).every_log],
        isolate=workflow.is_main_process,
    )
    if SETTINGS["source"] == "sim":
        refuse_to_overwrite(THERE)
    elif SETTINGS["source"] == "rig":
        refuse_simulated(THERE)
    PLAN = Plan(SETTINGS, THERE)
    if not PLAN.contents:
        raise LogError(
            f"source is recorded, and no raw log is in {RAW}: put sweep.h5 and complex.h5 there, "
            "or set folders.raw; see docs/own-data.md"
        )
except FprcError as error:
    raise WorkflowError(str(error)) from None

PATHS = PLAN.paths
EVALUATION = SETTINGS["evaluation"]
PUBLISHED = "config/published.yaml"
GAINS = PATHS.below("control/gains.json")

#: What simulates the hysteresis experiments, as RigSettings takes it.
ON_RIG = {
    "rig": SETTINGS["rig"],
    "control": SETTINGS["control"],
    "signals": SETTINGS["experiments"],
    "target": EVALUATION["target"],
}

#: What a report says of the data.
DATA = {
    "sim": "simulated rig, not hardware",
    "rig": "real rig",
    "recorded": "recorded logs",
}[SETTINGS["source"]]

#: Priorities: of what takes long, so that it is not left to the end, and of what wants the whole
#: machine. The scheduler adds up what it begins at once: ALONE outweighs a LONG one on every core.
LONG, ALONE = 1, workflow.cores + 1


def stage(name, *models, key="code"):
    """Return the params that name a stage, and the fingerprint of it and of the models it runs.

    ``key``: ``version`` where a checkpoint depends on it.
    """
    modules = ["fprc.stages.run", f"fprc.stages.{name.partition('.')[0]}"]
    modules += [class_module(model, SETTINGS["models"]) for model in models]
    return {"stage": name, key: fingerprint(*modules)}


def judgement(model=None, seed=SETTINGS["seed"]):
    """Return how models are judged, as Judgement takes it: one model, or all of them."""
    models = settings_of(model, SETTINGS["models"]) if model else SETTINGS["models"]
    how = {key: EVALUATION[key] for key in ("folds", "split")}
    return {"models": models, **how} | ({} if seed is None else {"seed": seed})


def refused(name):
    """Return an input function that ends the workflow by saying why."""

    def input_of(wildcards):
        raise WorkflowError(refusal(name, PLAN.unavailable))

    return input_of


def drawn(stem, statistics=False, **report_of):
    """Return the files of a figure: two pictures, where they come from, the numbers drawn."""
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
        labels={"figure": result.title, "data": DATA},
    )


def workers_for(cells):
    """Return the processes of a grid: to start one takes as long as 20 cells."""
    # half of the cores are left to other jobs
    return max(1, min(workflow.cores // 2, cells // 20))


def grid_values(*names):
    """Return the values of grids."""
    return {name: SETTINGS["grids"][name] for name in names}


def workers_of(wildcards):
    """Return the processes of one of the paper's grids, or of a chunk of it."""
    grid = prod(map(len, grid_values(*GRID_SETTINGS[wildcards.grid]).values()))
    return workers_for(grid * len(GRID_MODELS[wildcards.grid]) // GRID_CHUNKS)


def tracking_of(reference, *names):
    """Return the settings of runs along one reference, and others by name."""
    names = ("angle_range_deg", "pressure_limit_kpa", *names)
    one = {reference: SETTINGS["tracking"]["references"][reference]}
    return {name: SETTINGS["tracking"][name] for name in names} | {"references": one}


def made_by_rules():
    """Return regular expressions of all that the rules write: outputs, logs, checkpoints."""
    checkpoints = [rule.params.get("checkpoint") for rule in workflow.rules]
    kept = [
        rf"{regex_from_filepattern(path).removesuffix('$')}(\.old)?" for path in checkpoints if path
    ]
    files = [path for rule in workflow.rules for path in (*rule.output, *rule.log)]
    return sorted({path.regex().pattern for path in files}.union(kept))
