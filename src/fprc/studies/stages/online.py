"""Verdicts on D1 to D3, tables and the figure of a model that learns while it runs."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullLocator

from fprc.artifacts import read_json
from fprc.figures import style
from fprc.paper import REFERENCES, SOURCES
from fprc.signals import rms
from fprc.studies.beyond.measurements import family_title
from fprc.studies.beyond.tables import named, wide
from fprc.studies.beyond.verdicts import Claim, Pair, claims_page, judge_family
from fprc.tables.text import write_table

#: Loops, as readers see them.
LOOPS = {"open": "open loop", "closed": "closed loop"}

#: Columns of the page of errors: loop, and whether the model learns.
_HEADINGS = {
    "Open loop, as trained": ("open", False),
    "Open loop, learning": ("open", True),
    "Closed loop, as trained": ("closed", False),
    "Closed loop, learning": ("closed", True),
}

#: Growth of the error that D1 allows.
_MOST = 1.10

#: Models, as readers see them.
_TITLES = {
    "fprc": "FPRC", "fprc_lowpass": "FPRC on low-passed theta_d", "fuzzy_linear": "Fuzzy-linear",
    "pd": "PD alone",
}  # fmt: skip


def _pair(
    text: str,
    ours: tuple[str, str, bool],
    theirs: tuple[str, str, bool],
    loop: str = "closed",
    reference: str = "all",
    limit: float = 1.0,
) -> Pair:
    """Compare two models, each with its condition and whether it learns."""
    return Pair((*ours, loop, reference), (*theirs, loop, reference), text, limit=limit)


_LEARNING = ("fprc", "none", True)
CLAIMS = {
    "D1": Claim(
        "learning keeps tracking within 10 % of the undisturbed for offsets of P_o up to 5 kPa",
        [
            _pair(f"{offset}, {words}", ("fprc", offset, True), _LEARNING, loop, limit=_MOST)
            for loop, words in LOOPS.items()
            for offset in ("-5 kPa", "+5 kPa")
        ],
    ),
    "D2": Claim(
        "with learning, P_o still beats low-passed theta_d",
        [
            _pair(words, _LEARNING, ("fprc_lowpass", "none", True), loop)
            for loop, words in LOOPS.items()
        ],
    ),
    "D3": Claim(
        "learning FPRC with PD beats PD alone, at 0.5 Hz and in the sweep",
        [
            _pair(words, _LEARNING, ("pd", "none", False), reference=reference)
            for reference, words in (("sine_0p5", "0.5 Hz"), ("sweep", "sweep"))
        ],
    ),
}

_RUN = ["model", "condition", "learns", "loop"]
#: Last line of the notes.
_DATA = f"Data: {SOURCES['sim']}."


def rmse_of(family: Mapping[str, Any]) -> pd.DataFrame:
    """Return errors in deg, tidy.

    Columns ``model``, ``condition``, ``learns``, ``loop``, ``reference``, ``unit`` and
    ``rmse_deg``; of the reference ``all`` it is the root mean square over those of Table IV.
    """
    rows = pd.DataFrame(
        ({**row, "unit": cell["unit"]} for cell in family["cells"] for row in cell.get("rows", ())),
        columns=[*_RUN, "reference", "rmse_deg", "unit"],
    )
    printed = rows[rows["reference"].isin(REFERENCES)]
    overall = printed.groupby([*_RUN, "unit"], sort=False)["rmse_deg"].agg(rms).reset_index()
    return pd.concat([rows, overall.assign(reference="all")])


def tabulate_verdicts(families: Sequence[str], **files: str) -> None:
    """Judge D1 to D3 in every family, and write the verdicts."""
    judged = []
    for family in map(read_json, families):
        by_run = rmse_of(family).set_index("unit").groupby([*_RUN, "reference"])["rmse_deg"]
        judged.append(judge_family(family, CLAIMS, dict(iter(by_run))))
    table = pd.concat(judged, ignore_index=True)
    tidy = table.assign(family=table["world"], verdict=table["words"])
    kept = ["family", "id", "claim", "part", "verdict", "mean", "low", "high", "units", "source"]
    note = (
        "Learning while it runs: verdicts on D1 to D3, with the means of "
        "the ratios. D1: at -5 and +5 kPa, in open and in closed loop; D2: open and closed loop; "
        "D3: at 0.5 Hz and in the sweep."
    )
    write_table(tidy[kept], claims_page(table), f"{note}\n{_DATA}", **files)


def tabulate_errors(families: Sequence[str], **files: str) -> None:
    """Write the tracking errors under every condition; the page has those of the first family."""
    found = [read_json(path) for path in families]
    errors = pd.concat(rmse_of(family).assign(family=family["name"]) for family in found)
    overall = errors[errors["reference"] == "all"].groupby(["family", *_RUN], sort=False)
    numbers = {"mean_deg": "mean", "low_deg": "min", "high_deg": "max", "units": "count"}
    table = overall["rmse_deg"].agg(**numbers).reset_index().assign(source="sim")
    table["condition"] = table["condition"].map(_words)
    first = table[table["family"] == found[0]["name"]].rename(columns={"mean_deg": "mean"})
    page = wide(first, ["model", "condition"], ["loop", "learns"], _HEADINGS, intervals=False)
    titles: dict[str, Callable[[Any], str]] = {
        "Model": _TITLES.__getitem__,
        "Changed since the training": str,
    }
    note = (
        f"Tracking error on the rig {family_title(found[0]['name'])}, root mean square over the "
        f"four references of Table IV, mean over {int(first['units'].max())} seeds [deg]. "
        "Re-zeroed, an FPRC with a constant offset of P_o is one without."
    )
    write_table(table, named(page, **titles), f"{note}\n{_DATA}", **files)


def _words(condition: str) -> str:
    if condition.endswith(" kPa"):
        return f"P_o {condition}"
    return {
        "none": "nothing", "leak": "P_o falls by 4 kPa a minute",
        "warmer": "5 K warmer from half the run on", "stiffer": "actuator 10 % stiffer",
        "worn": "20 % less friction",
    }[condition]  # fmt: skip


def plot_offsets(table: pd.DataFrame, ax: Axes) -> None:
    """Draw FPRC's error over the offset of P_o, as trained and learning; and Fuzzy-linear's."""
    of_fprc = table[table["model"] == "fprc"]
    offsets = of_fprc["condition"].str.extract(r"P_o ([+-][\d.]+) kPa")[0]
    offsets = offsets.mask(of_fprc["condition"] == _words("none"), "0")
    of_fprc = of_fprc.assign(offset=pd.to_numeric(offsets)).dropna(subset=["offset"])
    for learns, marker, color in ((False, "o", "0.55"), (True, "s", "black")):
        line = of_fprc[of_fprc["learns"] == learns].sort_values("offset")
        label = "FPRC, learning" if learns else "FPRC as trained"
        ax.plot(line["offset"], line["mean_deg"], marker=marker, color=color, markersize=3,
                label=label)  # fmt: skip
        ax.fill_between(line["offset"], line["low_deg"], line["high_deg"], color=color, alpha=0.2,
                        linewidth=0)  # fmt: skip
    other = table[(table["model"] == "fuzzy_linear") & (table["condition"] == _words("none"))]
    for learns, dashes in ((False, ":"), (True, "--")):
        level = other.loc[other["learns"] == learns, "mean_deg"]
        if len(level):
            label = "Fuzzy-linear, learning" if learns else "Fuzzy-linear as trained"
            ax.axhline(level.iloc[0], color=style.SIGNALS["theta"], linestyle=dashes, linewidth=0.9,
                       label=label)  # fmt: skip
    ax.set(xlabel="Offset of $P_o$ [kPa]", ylabel="RMSE [deg]", yscale="log")


def draw_online(errors: str, pdf: str, png: str, *, names: Sequence[str]) -> None:
    """Draw the tracking error over the offset of P_o, with and without learning."""
    table = pd.read_csv(errors)
    fig, axes = style.figure(2, len(names), style.PAGE_IN, 3.6, sharex=True, sharey=True)
    for column, name in enumerate(names):
        for row, loop in enumerate(LOOPS):
            ax = axes[row][column]
            plot_offsets(table[(table["family"] == name) & (table["loop"] == loop)], ax)
            ax.set_title(f"{family_title(name)}, {LOOPS[loop]}")
            ax.label_outer()
    axes[0][0].yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes[0][0].yaxis.set_major_formatter("{x:g}")
    axes[0][0].yaxis.set_minor_locator(NullLocator())
    style.share_legend(fig, axes[0][0])
    style.save(fig, {"source": "sim", "seeds": []}, pdf, png)
