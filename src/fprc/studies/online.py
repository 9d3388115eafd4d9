"""Verdicts on D1 to D3, tables and the figure of a model that learns while it runs."""

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import pandas as pd
from matplotlib.ticker import LogLocator, NullLocator

from fprc.figures import style
from fprc.given import read_json
from fprc.paper import REFERENCES, SOURCES
from fprc.registry import title_of
from fprc.signals import rms
from fprc.studies.verdicts import Claim, Pair, claims_page, decide, family_title, wide
from fprc.tables.text import three_digits, write_table

#: Loops, as readers see them.
LOOPS = {"open": "open loop", "closed": "closed loop"}
#: Columns of the page of errors: loop, and whether the model learns.
_HEADINGS = {
    f"{words.capitalize()}, {how}": (loop, learns)
    for loop, words in LOOPS.items()
    for learns, how in ((False, "as trained"), (True, "learning"))
}
#: Conditions that are not an offset of P_o, as readers see them.
_CONDITIONS = {
    "none": "nothing",
    "leak": "P_o falls by 4 kPa a minute",
    "warmer": "5 K warmer from half the run on",
    "stiffer": "actuator 10 % stiffer",
    "worn": "20 % less friction",
}


def _over(theirs: tuple[Any, ...], text: str, condition: str = "none", limit: float = 1.0) -> Pair:
    """Return FPRC that learns, under a condition, over another run of the same loop."""
    return Pair(("fprc", condition, True, *theirs[-2:]), theirs, text, limit)


CLAIMS = {
    "D1": Claim(
        "learning keeps tracking within 10 % of the undisturbed for offsets of P_o up to 5 kPa",
        [
            _over(("fprc", "none", True, loop, "all"), f"{offset}, {words}", offset, 1.10)
            for loop, words in LOOPS.items()
            for offset in ("-5 kPa", "+5 kPa")
        ],
    ),
    "D2": Claim(
        "with learning, P_o still beats low-passed theta_d",
        [
            _over(("fprc_lowpass", "none", True, loop, "all"), words)
            for loop, words in LOOPS.items()
        ],
    ),
    "D3": Claim(
        "learning FPRC with PD beats PD alone, at 0.5 Hz and in the sweep",
        [
            _over(("pd", "none", False, "closed", "sine_0p5"), "0.5 Hz"),
            _over(("pd", "none", False, "closed", "sweep"), "sweep"),
        ],
    ),
}

_RUN = ["model", "condition", "learns", "loop"]


def tabulate_online(
    families: Sequence[str], verdicts: Sequence[str], errors: Sequence[str], figure: Sequence[str]
) -> None:
    """Judge D1 to D3 in every family; write verdicts and errors, and draw the errors.

    The page of errors has those of the first family, the figure those of the first three.
    """
    found = [read_json(path) for path in families]
    judged = pd.concat(map(decided, found), ignore_index=True)
    note = (
        "Learning while it runs: verdicts on D1 to D3, with the means of the ratios. D1: at -5 and "
        "+5 kPa, in open and in closed loop; D2: open and closed loop; D3: at 0.5 Hz and in the "
        f"sweep.\nData: {SOURCES['sim']}."
    )
    write_table(judged, claims_page(judged), note, *verdicts)
    rmse = pd.concat(rmse_of(family).assign(family=family["name"]) for family in found)
    overall = rmse[rmse["reference"] == "all"].groupby(["family", *_RUN], sort=False)["rmse_deg"]
    table = overall.agg(mean_deg="mean", low_deg="min", high_deg="max", units="count")
    table = table.reset_index().assign(source="sim")
    table["condition"] = table["condition"].map(lambda key: _CONDITIONS.get(key, f"P_o {key}"))
    first = table[table["family"] == found[0]["name"]]
    named = first[(first["model"] == "fprc") | (first["condition"] == "nothing")].assign(
        text=first["mean_deg"].map(three_digits),
        model=first["model"].map(lambda name: "PD alone" if name == "pd" else title_of(name)),
    )
    rows = {"model": "Model", "condition": "Changed since the training"}
    note = (
        f"Tracking error on the rig {family_title(found[0]['name'])}, root mean square over the "
        f"four references of Table IV, mean over {first['units'].max()} seeds [deg]. Re-zeroed, an "
        f"FPRC with a constant offset of P_o is one without.\nData: {SOURCES['sim']}."
    )
    write_table(table, wide(named, rows, ["loop", "learns"], _HEADINGS), note, *errors)
    draw_errors(table, figure)


def rmse_of(family: Mapping[str, Any]) -> pd.DataFrame:
    """Return errors by run and ``unit``, deg; ``all`` has the RMS over Table IV's references."""
    rows = pd.DataFrame(
        ({**row, "unit": cell["unit"]} for cell in family["cells"] for row in cell.get("rows", ())),
        columns=[*_RUN, "reference", "rmse_deg", "unit"],
    )
    printed = rows[rows["reference"].isin(REFERENCES)]
    overall = printed.groupby([*_RUN, "unit"], sort=False)["rmse_deg"].agg(rms).reset_index()
    return pd.concat([rows, overall.assign(reference="all")])


def decided(family: Mapping[str, Any]) -> pd.DataFrame:
    """Return the verdicts on D1 to D3 in a family, see ``fprc.studies.verdicts.decide``."""
    by_run = rmse_of(family).set_index("unit").groupby([*_RUN, "reference"])["rmse_deg"]
    return decide(family, CLAIMS, dict(iter(by_run)))


def draw_errors(table: pd.DataFrame, figure: Sequence[str]) -> None:
    """Draw FPRC's and Fuzzy-linear's errors in three families over the offset of P_o.

    As trained and learning; FPRC's with a band of the range over units.
    """
    offsets = table["condition"].replace("nothing", "P_o 0 kPa").str.extract(r"^P_o (\S+) kPa$")[0]
    table = table.assign(offset=pd.to_numeric(offsets)).dropna(subset="offset")
    runs = table.set_index(["family", "loop", "model", "learns"]).sort_index()
    names = table["family"].unique()[:3]
    fig, axes = style.figure(
        2, len(names), style.PAGE_IN, 3.6, sharex=True, sharey=True, squeeze=False
    )
    looks = {False: (" as trained", "o", "0.55", ":"), True: (", learning", "s", "black", "--")}
    for ax, (loop, name) in zip(axes.flat, product(LOOPS, names), strict=True):
        for learns, (words, marker, colour, _) in looks.items():
            line = runs.loc[(name, loop, "fprc", learns)].sort_values("offset")
            ax.plot(line["offset"], line["mean_deg"], marker=marker, color=colour, markersize=3,
                    label=f"FPRC{words}")  # fmt: skip
            ax.fill_between(line["offset"], line["low_deg"], line["high_deg"], color=colour,
                            alpha=0.2, linewidth=0)  # fmt: skip
        for learns, (words, *_, dashes) in looks.items():
            level = runs.loc[(name, loop, "fuzzy_linear", learns), "mean_deg"]
            ax.axhline(level, color=style.SIGNALS["theta"], linestyle=dashes, linewidth=0.9,
                       label=f"Fuzzy-linear{words}")  # fmt: skip
        ax.set(xlabel="Offset of $P_o$ [kPa]", ylabel="RMSE [deg]", yscale="log")
        ax.set_title(f"{family_title(name)}, {LOOPS[loop]}", loc="center")
        ax.label_outer()
    axis = axes[0, 0].yaxis
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_locator(NullLocator())
    style.share_legend(fig, axes[0, 0])
    style.save(fig, {"source": "sim", "seeds": []}, *figure)
