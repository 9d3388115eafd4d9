# Names that several rules share.
from snakemake.io import regex_from_filepattern

MODELS = ["esn", "fprc", "fuzzy_linear"]
SEEDS = SETTINGS["evaluation"]["replicate_seeds"]

#: The log that trains the models of a table, and the one that tests them.
TRAINED_ON = {"2": "sweep", "3": "complex"}
OTHER = {"sweep": "complex", "complex": "sweep"}

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
DATA = {"sim": "simulated rig, not hardware", "recorded": "recorded logs"}[SETTINGS["source"]]

TIMING = [f"{RESULTS}/timing/{name}.md" for name in ("table2_timing", "step_cost")]

#: What the page shows; without a rig there are no closed loops, further seeds and claims.
ON_RIG = SETTINGS["source"] == "sim"
CLAIMS = [f"{RESULTS}/claims.json"] if ON_RIG else []
SHOWN = {number: path for number, path in FIGURES.items() if ON_RIG or number < 12}
READOUT = f"{RESULTS}/readout/readout.md"
PAGES = [TABLES[1], TABLES[2], TABLES[3], READOUT, *TIMING]
if ON_RIG:
    II, III, IV, _ = SEEDS_TABLES
    PAGES = [TABLES[1], TABLES[2], II, TABLES[3], III, TABLES[4], IV, READOUT, *TIMING]


ENSEMBLE = SETTINGS["ensemble"]
CONTROLLERS = [
    "fprc",
    "fprc_pd_printed",
    "fprc_pd_identified",
    "pd_printed",
    "pd_identified",
]
TABLE_IV = ["sine_0p2", "sine_0p5", "sweep", "complex"]


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


def settings_of(model):
    """Return the settings that a model reads; Fuzzy-linear reads two of FPRC's."""
    shared = {key: SETTINGS["models"][key] for key in ("n_y", "alpha")}
    if model == "fuzzy_linear":
        own = {key: SETTINGS["models"]["fprc"][key] for key in ("n_c", "sigma")}
        return {**shared, "fprc": own}
    return {**shared, model: SETTINGS["models"][model]}


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
    logs = [f"{RAW}/{experiment}.h5" for experiment in EXPERIMENTS]
    data = [f"{RESULTS}/data/{experiment}.h5" for experiment in EXPERIMENTS]
    quality = [f"{RESULTS}/quality/{experiment}.json" for experiment in EXPERIMENTS]
    return [*logs, *data, *quality, *files]


def table(name):
    """Return the three files of a table."""
    return {kind: f"{RESULTS}/{name}.{kind}" for kind in ("csv", "md", "tex")}


def figure(name):
    """Return the files of a figure: two pictures, and where they come from."""
    number = int(name[3:5])
    png = report(
        f"{RESULTS}/figures/{name}.png",
        caption=f"../report/fig{number:02}.rst",
        category=next(title for title, numbers in CHAPTERS.items() if number in numbers),
        labels={"figure": f"Fig. {number}", "data": DATA},
    )
    stem = f"{RESULTS}/figures/{name}"
    return {"pdf": f"{stem}.pdf", "png": png, "sidecar": f"{stem}.json"}


SWEEPS = {name: f"{RESULTS}/sweeps/{name}.json" for name in ("epsilon", "n_c", "taps")}
TIMES = [f"{RESULTS}/timing/times.json", f"{RESULTS}/timing/times_over_n_c.json"]
GAINS = f"{RESULTS}/control/gains.json"
TRACKED = {
    reference: [tracked(reference, controller) for controller in CONTROLLERS]
    for reference in [*TABLE_IV, "disturbance"]
}
LOOP = [*judged("sweep"), GAINS]
RAW_LOGS = [
    *(f"{RAW}/{experiment}.h5" for experiment in EXPERIMENTS),
    *(path for paths in TRACKED.values() for path in paths),
]

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
    "fig10": through(FIGURES[10], SWEEPS["epsilon"], SWEEPS["n_c"], TIMES[1]),
    "readout": through(
        f"{RESULTS}/readout/readout.md",
        f"{RESULTS}/readout/readout.pdf",
        f"{RESULTS}/readout/cells.json",
    ),
    "fig11": through(FIGURES[11], SWEEPS["taps"]),
}
if ON_RIG:
    # these need a rig to run on, not only logs
    TARGETS |= {
        "seeds": [*SEEDS_TABLES, *REPLICATES, *REPLICATED_CONTROL],
        "table4": through(TABLES[4], *LOOP, *sum(TRACKED.values(), [])),
        "fig12": through(FIGURES[12], *LOOP, *TRACKED["sine_0p2"]),
        "fig13": through(FIGURES[13], *LOOP, *TRACKED["sine_0p5"]),
        "fig14": through(FIGURES[14], *LOOP, *TRACKED["sweep"]),
        "fig15": through(FIGURES[15], *LOOP, *TRACKED["complex"]),
        "fig16": through(FIGURES[16], *LOOP, *TRACKED["sine_0p5"], *TRACKED["sweep"]),
        "claims": [
            f"{RESULTS}/claims.md",
            *REPLICATES,
            *REPLICATED_SWEEPS,
            *REPLICATED_CONTROL,
            *TIMES,
        ],
        "fig17": through(FIGURES[17], *LOOP, *TRACKED["disturbance"]),
    }

TARGETS["report"] = [f"{RESULTS}/report.html", *sum(TARGETS.values(), [])]


def swept(*names):
    """Return the values of sweeps."""
    return {name: SETTINGS["sweeps"][name] for name in names}


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
