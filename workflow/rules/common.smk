# Names that several rules share.
MODELS = ["esn", "fprc", "fuzzy_linear"]
SEEDS = SETTINGS["evaluation"]["replicate_seeds"]

TABLES = [f"{RESULTS}/tables/{name}.md" for name in ("table1", "table2")]
# further seeds are a matter of the simulated rig; recorded logs have none
SEEDS_TABLE = [f"{RESULTS}/tables/table2_seeds.md"] if SETTINGS["source"] == "sim" else []
FIGURES = [
    f"{RESULTS}/figures/{name}.pdf"
    for name in ("fig04_hysteresis_actuator", "fig05_hysteresis_reservoir", "fig08_training")
]
TIMING = f"{RESULTS}/timing/table2_timing.csv"


def table(name):
    """Return the three files of a table."""
    return {kind: f"{RESULTS}/{name}.{kind}" for kind in ("csv", "md", "tex")}


def figure(name):
    """Return the two files of a figure."""
    caption = f"../report/{name.split('_')[0]}.rst"
    pdf = report(f"{RESULTS}/figures/{name}.pdf", caption=caption, category="Figures")
    return {"pdf": pdf, "png": f"{RESULTS}/figures/{name}.png"}
