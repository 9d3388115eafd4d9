# Settings and functions that several rules share.
from math import prod

from snakemake.io import regex_from_filepattern

try:
    # every job reads this file again, but only the main process meets logs that may be damaged and
    # therefore reads them in a child process
    EXISTING = headers(
        [f"{RAW}/{name}.h5" for name in Plan(SETTINGS, {}).every_log],
        isolate=workflow.is_main_process,
    )
    if SETTINGS["source"] == "sim":
        refuse_to_overwrite(EXISTING)
    elif SETTINGS["source"] == "rig":
        refuse_simulated(EXISTING)
    PLAN = Plan(SETTINGS, EXISTING)
    if not PLAN.contents:
        raise LogError(
            f"source is recorded, but {RAW} contains no raw log: put sweep.h5 and complex.h5 "
            "there, or set folders.raw; see docs/own-data.md"
        )
except FprcError as error:
    raise WorkflowError(str(error)) from None

PATHS = PLAN.paths
EVALUATION = SETTINGS["evaluation"]
PUBLISHED = "config/published.yaml"
GAINS = PATHS.below("control/gains.json")

#: Arguments of RigSettings.
ON_RIG = {
    "rig": SETTINGS["rig"],
    "control": SETTINGS["control"],
    "signals": SETTINGS["experiments"],
    "target": EVALUATION["target"],
}

#: Source of the data, as the report shows it.
DATA = {
    "sim": "simulated rig, not hardware",
    "rig": "real rig",
    "recorded": "recorded logs",
}[SETTINGS["source"]]

#: Priorities: LONG starts long jobs early; ALONE is for jobs that need the whole machine. The
#: scheduler sums the priorities of jobs that start together: ALONE outweighs LONG on every core.
LONG, ALONE = 1, workflow.cores + 1


def stage(name, *models, key="code"):
    """Return the params of a stage: its name, and the fingerprint of its code and its models.

    ``key`` names the fingerprint: ``version`` if the stage's checkpoint depends on it.
    """
    modules = ["fprc.stages.run", f"fprc.stages.{name.partition('.')[0]}"]
    modules += [class_module(model, SETTINGS["models"]) for model in models]
    return {"stage": name, key: fingerprint(*modules)}


#: The section ``models`` without models from outside the paper.
PAPERS = SETTINGS["models"] | {"others": {}}


def judgement(model=None, seed=SETTINGS["seed"]):
    """Return the arguments of Judgement for one model, or for all of them."""
    models = settings_of(model, SETTINGS["models"]) if model else SETTINGS["models"]
    how = {key: EVALUATION[key] for key in ("folds", "split", "purge_s")}
    return {"models": models, **how} | ({} if seed is None else {"seed": seed})


def refused(name):
    """Return an input function that ends the workflow with the reason."""

    def input_of(wildcards):
        raise WorkflowError(refusal(name, PLAN.unavailable))

    return input_of


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
        labels={"figure": result.title, "data": DATA},
    )


def workers_for(cells):
    """Return the number of processes of a grid; starting one takes as long as 20 cells."""
    # leave half of the cores to other jobs
    return max(1, min(workflow.cores // 2, cells // 20))


def grid_values(*names):
    """Return the values of some grids, by name."""
    return {name: SETTINGS["grids"][name] for name in names}


def workers_of(wildcards):
    """Return the number of processes of one of the paper's grids, or of a chunk of it."""
    grid = prod(map(len, grid_values(*GRID_SETTINGS[wildcards.grid]).values()))
    return workers_for(grid * len(GRID_MODELS[wildcards.grid]) // GRID_CHUNKS)


def tracking_of(reference, *names):
    """Return the tracking settings for one reference, with further ones by name."""
    names = ("angle_range_deg", "pressure_limit_kpa", *names)
    one = {reference: SETTINGS["tracking"]["references"][reference]}
    return {name: SETTINGS["tracking"][name] for name in names} | {"references": one}


def made_by_rules():
    """Return regular expressions of all files of the rules: outputs, logs, checkpoints."""
    checkpoints = [rule.params.get("checkpoint") for rule in workflow.rules]
    kept = [
        rf"{regex_from_filepattern(path).removesuffix('$')}(\.old)?" for path in checkpoints if path
    ]
    files = [path for rule in workflow.rules for path in (*rule.output, *rule.log)]
    return sorted({path.regex().pattern for path in files}.union(kept))
