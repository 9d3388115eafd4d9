# Names that several rules share.
MODELS = ["esn", "fprc", "fuzzy_linear"]
SEEDS = SETTINGS["evaluation"]["replicate_seeds"]

#: The log that trains the models of a table, and the one that tests them.
TRAINED_ON = {"2": "sweep", "3": "complex"}
OTHER = {"sweep": "complex", "complex": "sweep"}

TABLES = [f"{RESULTS}/tables/{name}.md" for name in ("table1", "table2", "table3", "table4")]
REPLICATES = [f"{RESULTS}/replicates/seed_{seed}.json" for seed in SEEDS]
SEEDS_TABLES = [
    f"{RESULTS}/tables/{name}" for name in ("table2_seeds.md", "table3_seeds.md", "orders.csv")
]
FIGURES = {
    name.split("_")[0]: f"{RESULTS}/figures/{name}.pdf"
    for name in (
        "fig04_hysteresis_actuator",
        "fig05_hysteresis_reservoir",
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
TIMING = f"{RESULTS}/timing/table2_timing.csv"


CONTROLLERS = [
    "fprc",
    "fprc_pd_printed",
    "fprc_pd_identified",
    "pd_printed",
    "pd_identified",
]
TABLE_IV = ["sine_0p2", "sine_0p5", "sweep", "complex"]


def tracked(reference, controller):
    """Return the raw log of one closed-loop run."""
    return f"{RAW}/track_{reference}_{controller}.h5"


def table(name):
    """Return the three files of a table."""
    return {kind: f"{RESULTS}/{name}.{kind}" for kind in ("csv", "md", "tex")}


def figure(name):
    """Return the two files of a figure."""
    caption = f"../report/{name.split('_')[0]}.rst"
    pdf = report(f"{RESULTS}/figures/{name}.pdf", caption=caption, category="Figures")
    return {"pdf": pdf, "png": f"{RESULTS}/figures/{name}.png"}
