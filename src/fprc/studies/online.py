"""Verdicts on D1 to D3, tables and the figure of a model that learns while it runs."""

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullLocator

from fprc.artifacts import read_json
from fprc.figures import style
from fprc.paper import REFERENCES, SOURCES
from fprc.registry import title_of
from fprc.signals import rms
from fprc.studies.verdicts import Claim, Pair, claims_page, decide, family_title, wide
from fprc.tables.text import write_table

#: Loops, as readers see them.
LOOPS = {"open": "open loop", "closed": "closed loop"}

#: Columns of the page of errors: loop, and whether the model learns.
_HEADINGS = {
    f"{words.capitalize()}, {how}": (loop, learns)
    for loop, words in LOOPS.items()
    for learns, how in ((False, "as trained"), (True, "learning"))
}


def _over(
    text: str, ours: str, other: str, learns: bool, loop: str, reference: str, limit: float = 1.0
) -> Pair:
    """Return learning FPRC under a condition over a model under none."""
    return Pair(
        ("fprc", ours, True, loop, reference), (other, "none", learns, loop, reference), text, limit
    )


CLAIMS = {
    "D1": Claim(
        "learning keeps tracking within 10 % of the undisturbed for offsets of P_o up to 5 kPa",
        [
            _over(f"{offset}, {words}", offset, "fprc", True, loop, "all", 1.10)
            for loop, words in LOOPS.items()
            for offset in ("-5 kPa", "+5 kPa")
        ],
    ),
    "D2": Claim(
        "with learning, P_o still beats low-passed theta_d",
        [_over(words, "none", "fprc_lowpass", True, loop, "all") for loop, words in LOOPS.items()],
    ),
    "D3": Claim(
        "learning FPRC with PD beats PD alone, at 0.5 Hz and in the sweep",
        [
            _over(words, "none", "pd", False, "closed", reference)
            for reference, words in (("sine_0p5", "0.5 Hz"), ("sweep", "sweep"))
        ],
    ),
}

_RUN = ["model", "condition", "learns", "loop"]
_VERDICTS_NOTE = (
    "Learning while it runs: verdicts on D1 to D3, with the means of the ratios. D1: at -5 and +5 "
    "kPa, in open and in closed loop; D2: open and closed loop; D3: at 0.5 Hz and in the sweep.\n"
    f"Data: {SOURCES['sim']}."
)
_ERRORS_NOTE = (
    "Tracking error on the rig {title}, root mean square over the four references of Table IV, "
    "mean over {units} seeds [deg]. Re-zeroed, an FPRC with a constant offset of P_o is one "
    f"without.\nData: {SOURCES['sim']}."
)


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


def tabulate_online(
    families: Sequence[str],
    verdicts: Sequence[str],
    errors: Sequence[str],
    figure: Sequence[str],
    *,
    shown: Sequence[str],
) -> None:
    """Judge D1 to D3 in every family; write verdicts and errors, and draw the errors.

    The page of errors has those of the first family, the figure those of the families ``shown``.
    """
    found = [read_json(path) for path in families]
    judged = pd.concat(map(decided, found), ignore_index=True)
    write_table(judged, claims_page(judged), _VERDICTS_NOTE, *verdicts)
    table = errors_of(found)
    first = table[table["family"] == found[0]["name"]].rename(columns={"mean_deg": "mean"})
    page = wide(
        first[(first["model"] == "fprc") | (first["condition"] == _words("none"))],
        {"model": ("Model", _title), "condition": ("Changed since the training", str)},
        ["loop", "learns"],
        _HEADINGS,
    )
    title = family_title(found[0]["name"])
    note = _ERRORS_NOTE.format(title=title, units=int(first["units"].max()))
    write_table(table, page, note, *errors)
    draw_errors(table, figure, shown)


def decided(family: Mapping[str, Any]) -> pd.DataFrame:
    """Return the verdicts on D1 to D3 in a family, see ``fprc.studies.verdicts.decide``."""
    by_run = rmse_of(family).set_index("unit").groupby([*_RUN, "reference"])["rmse_deg"]
    return decide(family, CLAIMS, dict(iter(by_run)))


def errors_of(families: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return the tracking errors under every condition, mean and range over units, tidy."""
    rmse = pd.concat(rmse_of(family).assign(family=family["name"]) for family in families)
    overall = rmse[rmse["reference"] == "all"].groupby(["family", *_RUN], sort=False)
    numbers = {"mean_deg": "mean", "low_deg": "min", "high_deg": "max", "units": "count"}
    table = overall["rmse_deg"].agg(**numbers).reset_index().assign(source="sim")
    return table.assign(condition=table["condition"].map(_words))


def _title(name: str) -> str:
    return "PD alone" if name == "pd" else title_of(name)


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
    offsets = table["condition"].replace(_words("none"), "P_o 0 kPa")
    offsets = pd.to_numeric(offsets.str.extract(r"^P_o (\S+) kPa$")[0])
    table = table.assign(offset=offsets).dropna(subset="offset").sort_values("offset")
    runs = table.set_index(["model", "learns"]).sort_index(kind="stable")
    looks = ((" as trained", "o", "0.55", ":"), (", learning", "s", "black", "--"))
    for learns, (words, marker, color, _) in enumerate(looks):
        line = runs.loc["fprc", bool(learns)]
        ax.plot(line["offset"], line["mean_deg"], marker=marker, color=color, markersize=3,
                label=f"FPRC{words}")  # fmt: skip
        ax.fill_between(line["offset"], line["low_deg"], line["high_deg"], color=color, alpha=0.2,
                        linewidth=0)  # fmt: skip
    for learns, (words, *_, dashes) in enumerate(looks):
        (level,) = runs.loc[[("fuzzy_linear", bool(learns))], "mean_deg"]
        ax.axhline(level, color=style.SIGNALS["theta"], linestyle=dashes, linewidth=0.9,
                   label=f"Fuzzy-linear{words}")  # fmt: skip
    ax.set(xlabel="Offset of $P_o$ [kPa]", ylabel="RMSE [deg]", yscale="log")


def draw_errors(table: pd.DataFrame, figure: Sequence[str], names: Sequence[str]) -> None:
    """Draw the tracking error of families over the offset of P_o, with and without learning."""
    fig, axes = style.figure(2, len(names), style.PAGE_IN, 3.6, sharex=True, sharey=True)
    for ax, (loop, name) in zip(axes.flat, product(LOOPS, names), strict=True):
        plot_offsets(table[(table["family"] == name) & (table["loop"] == loop)], ax)
        ax.set_title(f"{family_title(name)}, {LOOPS[loop]}")
        ax.label_outer()
    axes[0][0].yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes[0][0].yaxis.set_major_formatter("{x:g}")
    axes[0][0].yaxis.set_minor_locator(NullLocator())
    style.share_legend(fig, axes[0][0])
    style.save(fig, {"source": "sim", "seeds": []}, *figure)
