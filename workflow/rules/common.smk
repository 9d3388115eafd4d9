# What several rules share.
from snakemake.io import regex_from_filepattern

try:
    # a job reads this file again; by then its main process has looked at the logs, from a safe place
    THERE = headers(
        [f"{RAW}/{name}.h5" for name in Plan(SETTINGS, {}).every_log],
        alone=workflow.is_main_process,
    )
    if SETTINGS["source"] == "sim":
        refuse_to_overwrite(THERE)
    elif SETTINGS["source"] == "hardware":
        refuse_simulated(THERE)
    PLAN = Plan(SETTINGS, THERE)
    if not PLAN.held:
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
    "hardware": "real rig",
    "recorded": "recorded logs",
}[SETTINGS["source"]]

#: Priorities: of what takes long or is waited for, so that it is not left to the end, and of what
#: wants the whole machine, which begins as soon as no job runs. The scheduler adds up what it begins
#: at once: one that is alone outweighs a long one on every core.
LONG, ALONE = 1, workflow.cores + 1


def stage(name, *models, key="code"):
    """Return the params that name a rule's stage and the fingerprint of what it runs.

    ``models``: those whose code it runs. ``key``: ``version`` where a checkpoint depends on it.
    """
    classes = [class_module(model, SETTINGS["models"]) for model in models]
    return {"stage": name, key: fingerprint(f"fprc.stages.{name.split('.')[0]}", *classes)}


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
    """Return the processes of a sweep.

    To start one takes as long as twenty cells; half of the cores are left to other jobs.
    """
    return max(1, min(workflow.cores // 2, cells // 20))


def swept(*names):
    """Return the values of sweeps."""
    return {name: SETTINGS["sweeps"][name] for name in names}


def made_by_rules():
    """Return regular expressions of all that the rules write: outputs, logs, checkpoints."""
    checkpoints = [rule.params.get("checkpoint") for rule in workflow.rules]
    kept = [
        rf"{regex_from_filepattern(path).removesuffix('$')}(\.old)?" for path in checkpoints if path
    ]
    files = [path for rule in workflow.rules for path in (*rule.output, *rule.log)]
    return sorted({path.regex().pattern for path in files}.union(kept))


def pictures_of_documentation():
    """Return the pictures that rules put into the documentation, and the figures they are."""
    rules = [rule for rule in workflow.rules if rule.params.get("picture")]
    return {rule.params.picture: str(rule.input.figure) for rule in rules}
