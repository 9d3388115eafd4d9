# Names that several rules share.
from math import prod

from snakemake.io import regex_from_filepattern

CONTROLLERS = [
    "fprc",
    "fprc_pd_printed",
    "fprc_pd_identified",
    "pd_printed",
    "pd_identified",
]
TABLE_IV = ["sine_0p2", "sine_0p5", "sweep", "complex"]
ALL_RUNS = [
    f"track_{reference}_{controller}"
    for controller in CONTROLLERS
    for reference in [*TABLE_IV, "disturbance"]
]

#: Whether the rig is simulated, and with it further ones; whether logs are made at all.
ON_RIG = SETTINGS["source"] == "sim"
RECORDS = SETTINGS["source"] != "recorded"


def exists(log):
    """Whether a raw log is there."""
    return Path(f"{RAW}/{log}.h5").exists()


EVERY_LOG = [*EXPERIMENTS, *ALL_RUNS]
RAW_LOGS = [f"{RAW}/{name}.h5" for name in EVERY_LOG]
# a job reads this file again; by then its main process has looked at the logs, from a safe place
try:
    THERE = headers(RAW_LOGS, alone=workflow.is_main_process)
except FprcError as error:
    raise WorkflowError(str(error)) from None

#: The raw logs that are there or will be; what cannot be made of them, and why.
TO_COME = EVERY_LOG if ON_RIG else [name for name in EVERY_LOG if name not in THERE]
HELD = holdings(
    THERE,
    EVERY_LOG,
    to_come=TO_COME if RECORDS else [],
    without=[] if ON_RIG or SETTINGS["hardware"]["phi"] else ["phi_deg"],
)
if not HELD:
    raise WorkflowError(
        f"source is recorded, and no raw log is in {RAW}: put sweep.h5 and complex.h5 there, or "
        "set folders.raw; see docs/own-data.md"
    )
DRIVEN = SETTINGS["evaluation"]["reservoir"] == "simulated"
if DRIVEN:
    HELD |= {
        name: HELD[name].having(("p_i_kpa", "p_o_kpa", "phi_deg"))
        for name in EXPERIMENTS
        if name in HELD
    }
UNAVAILABLE = unavailable(HELD, RAW, ALL_RUNS, simulated=ON_RIG)
LOGS = [experiment for experiment in EXPERIMENTS if experiment in HELD]
RUNS = [run for run in ALL_RUNS if run in HELD]

MODELS = [model for model in ("esn", "fprc", "fuzzy_linear") if model not in UNAVAILABLE]
#: Why a model is left out of the tables.
LEFT_OUT = {model: UNAVAILABLE[model] for model in ("fprc",) if model in UNAVAILABLE}
SEEDS = SETTINGS["evaluation"]["replicate_seeds"]

#: What simulates the hysteresis experiments.
EXPERIMENTS_ON_RIG = {
    "rig": SETTINGS["rig"],
    "signals": SETTINGS["experiments"],
    "control": SETTINGS["control"],
    "target": SETTINGS["evaluation"]["target"],
}

#: The log that trains the models of a table; the other one tests them.
TRAINED_ON = {"2": "sweep", "3": "complex"}

TABLES = {number: f"{RESULTS}/tables/table{number}.md" for number in (1, 2, 3, 4)}
TARGET = SETTINGS["evaluation"]["target"]


def replicated(name, *targets):
    """Return the results of every further seed, for one or more targets of the models."""
    folders = [f"{RESULTS}/replicates/{target}" for target in targets or [TARGET]]
    return [f"{folder}/{name}_{seed}.json" for folder in folders for seed in SEEDS]


REPLICATES = replicated("models")
REPLICATED_SWEEPS = replicated("sweeps")
REPLICATED_CONTROL = replicated("control")
SEEDS_TABLES = [
    f"{RESULTS}/tables/{name}"
    for name in ("table2_seeds.md", "table3_seeds.md", "table4_seeds.md", "orders.csv")
]
FIGURES = {
    int(name[3:5]): f"{RESULTS}/figures/{name}.pdf"
    for name in (
        "fig01_actuator",
        "fig02_reservoir",
        "fig03_apparatus",
        "fig04_hysteresis_actuator",
        "fig05_hysteresis_reservoir",
        "fig06_esn_system",
        "fig07_fprc_system",
        "fig08_training",
        "fig09_weights",
        "fig10_settings",
        "fig11_taps",
        "fig12_sine_0p2",
        "fig13_sine_0p5",
        "fig14_sweep",
        "fig15_complex",
        "fig16_loops",
        "fig17_disturbance",
    )
}
#: The paper's sections that the figures stand in.
CHAPTERS = {
    "II Pneumatic bending actuators": range(1, 6),
    "III Feedforward hysteresis compensation": range(6, 12),
    "IV Experimental results": range(12, 18),
}
DATA = {
    "sim": "simulated rig, not hardware",
    "hardware": "real rig",
    "recorded": "recorded logs",
}[SETTINGS["source"]]

TIMING = [f"{RESULTS}/timing/{name}.md" for name in ("table2_timing", "step_cost")]

#: What the page shows.
CLAIMS = [f"{RESULTS}/claims.json"] if "claims" not in UNAVAILABLE else []
SHOWN = {number: path for number, path in FIGURES.items() if f"fig{number}" not in UNAVAILABLE}
READOUT = f"{RESULTS}/readout/readout.md"
PAGES = [
    page
    for target, page in [
        ("table1", TABLES[1]),
        ("table2", TABLES[2]),
        ("seeds", SEEDS_TABLES[0]),
        ("table3", TABLES[3]),
        ("seeds", SEEDS_TABLES[1]),
        ("table4", TABLES[4]),
        ("seeds", SEEDS_TABLES[2]),
        ("readout", READOUT),
        *[("timing", path) for path in TIMING],
    ]
    if target not in UNAVAILABLE
]
MISSING = {kind: f"{RESULTS}/not_available.{kind}" for kind in ("csv", "md")}

ENSEMBLE = SETTINGS["ensemble"]


#: Classes of each model, which the stages choose by its name.
_FUZZY = ["features.TapFeatures", "takagi_sugeno.TakagiSugenoReadout"]
CLASSES = {
    "esn": ["esn.ESN", "features.EchoStates", "ridge.RidgeReadout"],
    "fprc": ["fprc.FPRC", *_FUZZY],
    "fuzzy_linear": ["fprc.FuzzyLinear", *_FUZZY],
}


def code_of(script, *models):
    """Return the fingerprint of what a rule's script runs; ``models``: these and no others."""
    spared = set(sum(CLASSES.values(), []))
    spared -= {name for model in models or CLASSES for name in CLASSES[model]}
    return fingerprint(
        *imports_of(Path(workflow.basedir, f"workflow/scripts/{script}.py")),
        without=[f"fprc.models.{name}" for name in spared],
    )


def refused(name):
    """Return an input function that ends the workflow by saying why."""

    def input_of(wildcards):
        raise WorkflowError(refusal(name, UNAVAILABLE))

    return input_of


def settings_of(model):
    """Return the settings that a model reads; Fuzzy-linear reads two of FPRC's."""
    shared = {key: SETTINGS["models"][key] for key in ("n_y", "alpha")}
    if model == "fuzzy_linear":
        own = {key: SETTINGS["models"]["fprc"][key] for key in ("n_c", "sigma")}
        return {**shared, "fprc": own}
    return {**shared, model: SETTINGS["models"][model]}


def complete(experiment):
    """Return the raw log of an experiment, or what has a simulated reservoir in its place."""
    return f"{RESULTS}/reservoir/{experiment}.h5" if DRIVEN else f"{RAW}/{experiment}.h5"


def tracked(reference, controller):
    """Return the raw log of one closed-loop run."""
    return f"{RAW}/track_{reference}_{controller}.h5"


def judged(experiment):
    """Return what judging every model on one log gives."""
    return [
        f"{RESULTS}/{path}"
        for model in MODELS
        for path in (
            f"crossval/{experiment}_{model}.json",
            f"models/{experiment}_{model}.h5",
            f"predictions/{experiment}_{model}_train.h5",
            f"predictions/{experiment}_{model}_test.h5",
        )
    ]


def through(*files):
    """Return files, and with them the logs and data that all of them come from.

    A target names its intermediates too: when a job fails, Snakemake removes
    its outputs, and a target that asked for the final file alone would then
    find that file in place and call the stale result done.
    """
    logs = [f"{RAW}/{experiment}.h5" for experiment in LOGS]
    data = [f"{RESULTS}/data/{experiment}.h5" for experiment in LOGS]
    quality = [f"{RESULTS}/quality/{experiment}.json" for experiment in LOGS]
    driven = [complete(experiment) for experiment in LOGS] if DRIVEN else []
    return [*logs, *driven, *data, *quality, *files]


def table(name):
    """Return the three files of a table."""
    return {kind: f"{RESULTS}/{name}.{kind}" for kind in ("csv", "md", "tex")}


def figure(name, statistics=False):
    """Return the files of a figure: two pictures, where they come from, the numbers drawn."""
    number = int(name[3:5])
    png = report(
        f"{RESULTS}/figures/{name}.png",
        caption=f"../report/fig{number:02}.rst",
        category=next(title for title, numbers in CHAPTERS.items() if number in numbers),
        labels={"figure": f"Fig. {number}", "data": DATA},
    )
    stem = f"{RESULTS}/figures/{name}"
    files = {"pdf": f"{stem}.pdf", "png": png, "sidecar": f"{stem}.json"}
    return files | ({"csv": f"{stem}.csv"} if statistics else {})


SWEEPS = {name: f"{RESULTS}/sweeps/{name}.json" for name in ("epsilon", "n_c", "taps")}
TIMES = [f"{RESULTS}/timing/times.json", f"{RESULTS}/timing/times_over_n_c.json"]
GAINS = f"{RESULTS}/control/gains.json"
TRACKED = {
    reference: [
        tracked(reference, controller)
        for controller in CONTROLLERS
        if f"track_{reference}_{controller}" in HELD
    ]
    for reference in [*TABLE_IV, "disturbance"]
}
#: What the closed-loop runs come from, if they are not there already.
LOOP = through(*judged("sweep"), GAINS) if RECORDS else []

IDENTIFY = [f"identify_{kp:g}" for kp in SETTINGS["tracking"]["candidate_kp_kpa_per_deg"]]
#: Every experiment of the paper on the real rig.
RIG_LOGS = [*EXPERIMENTS, *IDENTIFY, *(Path(path).stem for path in RAW_LOGS[2:])]


def needed_on_rig(name):
    """Return what must be there before an experiment can run on the real rig."""
    model = f"{RESULTS}/models/sweep_fprc.h5"
    return [] if name in EXPERIMENTS else [model] if name in IDENTIFY else [model, GAINS]


#: Each target's files: the result first, then what it is made from.
TARGETS = {
    "table1": [TABLES[1]],
    "table2": through(TABLES[2], *judged("sweep")),
    "table3": through(TABLES[3], *judged("complex")),
    "timing": through(*TIMING, TIMES[0], f"{RESULTS}/timing/steps.json"),
    "fig1": through(FIGURES[1]),
    "fig2": through(FIGURES[2]),
    "fig3": [FIGURES[3]],
    "fig4": through(FIGURES[4]),
    "fig5": through(FIGURES[5]),
    "fig6": [FIGURES[6]],
    "fig7": [FIGURES[7]],
    "fig8": through(FIGURES[8], *judged("sweep")),
    "fig9": through(FIGURES[9], f"{RESULTS}/weights/fprc.json"),
    "fig10": through(
        FIGURES[10],
        *([SWEEPS["epsilon"]] if "fig10a" not in UNAVAILABLE else []),
        SWEEPS["n_c"],
        TIMES[1],
    ),
    "readout": through(
        f"{RESULTS}/readout/readout.md",
        f"{RESULTS}/readout/readout.pdf",
        f"{RESULTS}/readout/cells.json",
    ),
    "fig11": through(FIGURES[11], SWEEPS["taps"]),
    "seeds": [*SEEDS_TABLES, *REPLICATES, *REPLICATED_CONTROL],
    "table4": [TABLES[4], GAINS, *LOOP, *sum(TRACKED.values(), [])],
    "fig12": [FIGURES[12], *LOOP, *TRACKED["sine_0p2"]],
    "fig13": [FIGURES[13], *LOOP, *TRACKED["sine_0p5"]],
    "fig14": [FIGURES[14], *LOOP, *TRACKED["sweep"]],
    "fig15": [FIGURES[15], *LOOP, *TRACKED["complex"]],
    "fig16": [FIGURES[16], *LOOP, *TRACKED["sine_0p5"], *TRACKED["sweep"]],
    "claims": [
        f"{RESULTS}/claims.md",
        *REPLICATES,
        *REPLICATED_SWEEPS,
        *REPLICATED_CONTROL,
        *TIMES,
    ],
    "fig17": [FIGURES[17], *LOOP, *TRACKED["disturbance"]],
    "not_available": [*MISSING.values()],
}
#: Targets that cannot be made of the logs that are there.
REFUSED = [name for name in [*TARGETS, "readme", "check"] if name in UNAVAILABLE]
TARGETS = {name: files for name, files in TARGETS.items() if name not in UNAVAILABLE}
TARGETS["report"] = [f"{RESULTS}/report.html", *sum(TARGETS.values(), [])]


def swept(*names):
    """Return the values of sweeps."""
    return {name: SETTINGS["sweeps"][name] for name in names}


def workers_for(cells):
    """Return the processes of a sweep.

    To start one takes as long as twenty cells; half of the cores are left to other jobs.
    """
    return max(1, min(workflow.cores // 2, cells // 20))


def workers_of(wildcards):
    """Return the processes of one of the paper's sweeps, or of a chunk of it."""
    grid = prod(map(len, swept(*VALUES[wildcards.sweep]).values()))
    return workers_for(grid * len(SWEPT[wildcards.sweep]) // SWEEP_CHUNKS)


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


def pictures_of_documentation():
    """Return the pictures that rules put into the documentation, and the figures they are."""
    rules = [rule for rule in workflow.rules if rule.params.get("picture")]
    return {rule.params.picture: str(rule.input.figure) for rule in rules}
