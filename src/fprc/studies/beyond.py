"""What P_o is worth, and what FPRC's readout is worth: claims, tables, pages and the figure."""

from collections.abc import Mapping, Sequence
from itertools import cycle, product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from fprc import escape
from fprc.artifacts import write_csv, write_text
from fprc.evaluation.paired import EQUIVALENT_WITHIN
from fprc.figures import style
from fprc.given import read_json
from fprc.paper import SOURCES
from fprc.registry import SIDES, title_of
from fprc.studies.verdicts import Claim, Numbers, Pair, claims_page, decide, family_title, wide
from fprc.tables.text import markdown, means_of, three_digits, within

Families = Sequence[Mapping[str, Any]]

#: Measures of every model, as readers see them, with their units; errors are RMSE.
MEASURES = {
    "train": "training [kPa]",
    "blocks": "unseen blocks [kPa]",
    "forward": "forward test [kPa]",
    "reversed": "reversed test [kPa]",
    "open_loop": "open loop [deg]",
    "closed_loop": "closed loop [deg]",
}
#: Measures by which the best model of each side is chosen and judged.
BEST_MEASURES = [measure for measure in MEASURES if measure != "train"]

_WITHOUT, _WITH = zip(*SIDES.values(), strict=True)
#: Best models: for readers, and the models of which each is the best.
_BEST = {
    "without_p_o": ("Best without P_o", _WITHOUT),
    "with_p_o": ("Best with P_o", _WITH),
    "other_p_o": ("Best other with P_o", [name for name in _WITH if name != "fprc"]),
}


def model_title(name: str) -> str:
    """Return the name of a model, or of the best ones, for readers."""
    return _BEST[name][0] if name in _BEST else title_of(name)


def _pairs(ours: str, other: str, *measures: str) -> list[Pair]:
    names = f"{model_title(ours)} / {model_title(other)}"
    return [Pair((ours, m), (other, m), f"{names} ({m.replace('_', ' ')})") for m in measures]


_LOOPS = ("open_loop", "closed_loop")
#: Whom fits favour, by their terms.
_FPRC, _P_O = dict.fromkeys(("tables", "orders"), "FPRC"), {"C8": "P_o"}
CLAIMS = {
    "W1": Claim("P_o is worth a sensor, on unseen parts of the same motions",
                _pairs("with_p_o", "without_p_o", "blocks"), _P_O),
    "W2": Claim("P_o is worth a sensor, forward and reversed",
                _pairs("with_p_o", "without_p_o", "forward", "reversed"), _P_O),
    "W3": Claim("P_o is worth a sensor in tracking, open and closed loop",
                _pairs("with_p_o", "without_p_o", *_LOOPS), _P_O),
    "W4": Claim("FPRC beats the best other model of the same inputs, forward",
                _pairs("fprc", "other_p_o", "forward"), _FPRC),
    "B1": Claim("P_o beats low-passed theta_d, forward",
                _pairs("fprc", "fprc_lowpass", "forward"), _FPRC | _P_O),
    "B4": Claim("the fuzzy readout beats a ridge on the same features, forward",
                _pairs("fprc", "ridge_p_o", "forward"), _FPRC),
    "B7": Claim("FPRC whose P_o is 2 kPa low still beats Fuzzy-linear, forward and in tracking, "
                "open and closed loop",
                [Pair(("fprc", f"{measure}/-2"), ("fuzzy_linear", measure),
                      f"FPRC / Fuzzy-linear ({measure.replace('_', ' ')}, P_o 2 kPa low)")
                 for measure in ("forward", *_LOOPS)],
                _FPRC | dict.fromkeys((*_LOOPS, "closed_sweep"), "FPRC")),
    "B8": Claim("P_o has a nonlinear capacity of 0.1 or more, and its low-passes more memory than "
                "those of theta",
                [Pair(("threshold", "nonlinear"), ("p_o", "nonlinear"), "0.1 / nonlinear capacity"),
                 Pair(("theta", "memory_s"), ("p_o", "memory_s"), "memory of theta / of P_o")],
                _P_O),
}  # fmt: skip

#: What the ratios of the short table are, by the pair.
_WORTH = {
    "Best with P_o / Best without P_o (blocks)": "unseen parts of the same motions",
    "Best with P_o / Best without P_o (forward)": "another motion",
    "Best with P_o / Best without P_o (reversed)": "another motion, reversed",
    "Best with P_o / Best without P_o (open loop)": "tracking, open loop",
    "Best with P_o / Best without P_o (closed loop)": "tracking, closed loop",
    "FPRC / Best other with P_o (forward)": "FPRC over the best other model with P_o",
}

#: Marker and colour of each family, in their order, safe for colour-blind readers (Tol). Colours
#: are signals elsewhere, but no figure of families shows one.
_FAMILIES = (
    ("o", "#000000"), ("s", "#ee6677"), ("D", "#4477aa"),
    ("^", "#228833"), ("v", "#aa3377"), ("P", "#ccbb44"),
)  # fmt: skip
#: A ratio beyond this, or beyond one over it, is not shown: three units can have any interval.
_WIDEST = 5.0


def tabulate_beyond(
    families: Sequence[str], models: str, claims: str, pages: Sequence[str], figure: Sequence[str]
) -> None:
    """Judge the claims in every family; write the tables, and draw the ratios.

    ``models`` and ``claims`` are CSV; ``pages`` are tables in Markdown, which docs/beyond.md and
    others show, that of the models with those of the first family; their names are those below.
    """
    found = [read_json(path) for path in families]
    judged = [decide(family, CLAIMS, numbers_of(family)) for family in found]
    verdicts, means = pd.concat(judged, ignore_index=True), means_of_models(found)
    write_csv(models, means)
    write_csv(claims, verdicts)
    shown = {
        "claims": claims_page(verdicts),
        "best": best_page(found),
        "memory": memory_page(means),
        "worth": worth_page(verdicts),
        "models": models_page(means[means["family"] == found[0]["name"]]),
    }
    for path in pages:
        write_text(path, markdown(shown[Path(path).stem], f"Data: {SOURCES['sim']}."))
    fig, ax = style.figure(1, 1, style.PAGE_IN, 6.8)
    plot_pairs(verdicts, ax)
    style.share_legend(fig, ax)
    style.save(fig, {"source": "sim", "seeds": []}, *figure)


def measured(families: Families) -> pd.DataFrame:
    """Return every number of the models in families, tidy, see ``contest.judge_models``.

    What was not measured has no row, and neither has a model that could not be judged.
    """
    rows = [
        (family["name"], cell["unit"], model, measure, value)
        for family in families
        for cell in family["cells"]
        for model, report in cell.get("models", {}).items()
        if "failed" not in report
        for measure, value in report.items()
    ]
    columns = ["family", "unit", "model", "measure", "value"]
    return pd.DataFrame(rows, columns=columns).astype({"value": float})


def numbers_of(family: Mapping[str, Any]) -> Numbers:
    """Return the numbers of a family by model and measure, those of the best of each side too."""
    table = measured([family])
    by_name = table.set_index("unit").groupby(["model", "measure"])["value"]
    found: dict[tuple[Any, ...], pd.Series] = dict(iter(by_name))
    for side, measure in product(_BEST, BEST_MEASURES):
        found[side, measure] = best_of(table, side, measure)["value"]
    return found


def best_of(table: pd.DataFrame, side: str, measure: str) -> pd.DataFrame:
    """Return the best model of one side for each unit of a family, and its numbers.

    It has the lowest mean logarithm of the measure on the other units: the numbers of a unit do not
    choose what it is judged by. There is no row if there are fewer than two units, or not one model
    has all numbers. ``table`` is what ``measured`` gives of the family.
    """
    _, names = _BEST[side]
    rows = table[(table["measure"] == measure) & table["model"].isin(names)]
    units = np.log(rows.pivot(index="unit", columns="model", values="value"))
    units = units.reindex(columns=list(names)).dropna(axis=1)
    if len(units) < 2 or units.empty:
        return pd.DataFrame(columns=["model", "value"], dtype=float)
    best = (units.sum() - units).idxmin(axis=1)
    values = [units.loc[at, name] for at, name in best.items()]
    return pd.DataFrame({"model": best, "value": np.exp(values)}, index=units.index)


def means_of_models(families: Families) -> pd.DataFrame:
    """Return the mean of every measure over the units of each family, and its 95 % interval."""
    means = means_of(measured(families), "family", "model", "measure", count="units")
    return means.drop(columns=["std", "min", "max"]).assign(source="sim")


def _with_text(table: pd.DataFrame) -> pd.DataFrame:
    return table.assign(text=[
        within(row.mean, row.low, row.high) if row.units > 1 else three_digits(row.mean)
        for row in table.itertuples()
    ])  # fmt: skip


def models_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the models of one family as a page, the lowest forward test RMSE first."""
    forward = table[table["measure"] == "forward"].sort_values("mean", kind="stable")["model"]
    ranked = _with_text(table).set_index("model").loc[forward].reset_index()
    headings = {words[0].upper() + words[1:]: measure for measure, words in MEASURES.items()}
    page = wide(ranked, {"model": "Model"}, "measure", headings)
    units = ranked.groupby("model", sort=False)["units"].agg(["min", "max"])
    words = [
        f"{least} to {most}" if least < most else f"{most}"
        for least, most in units.itertuples(index=False)
    ]
    return page.assign(Model=page["Model"].map(model_title), Units=words)


def best_page(families: Families) -> pd.DataFrame:
    """Return the best model of each side by rigs and measure, with its mean error."""
    rows = []
    for family, measure in product(families, BEST_MEASURES):
        row = {"Rigs": family_title(family["name"]), "Error": MEASURES[measure]}
        for side in ("without_p_o", "with_p_o"):
            best = best_of(measured([family]), side, measure)
            name, error = best["model"].value_counts().index[:1], three_digits(best["value"].mean())
            row[model_title(side)] = f"{error}, {model_title(name[0])}" if len(name) else "-"
        rows.append(row)
    return pd.DataFrame(rows)


def memory_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return memory and nonlinear capacity of P_o and of theta, mean and 95 % interval, by rigs."""
    headings = {
        "P_o: memory [s]": ("p_o", "memory_s"),
        "P_o: nonlinear capacity": ("p_o", "nonlinear"),
        "theta: memory [s]": ("theta", "memory_s"),
        "theta: nonlinear capacity": ("theta", "nonlinear"),
    }
    named = _with_text(table).assign(family=table["family"].map(family_title))
    return wide(named, {"family": "Rigs"}, ["model", "measure"], headings)


def worth_page(verdicts: pd.DataFrame) -> pd.DataFrame:
    """Return the ratios of W1 to W4 by rigs, one row each; undecided ones in brackets."""
    rows = verdicts[verdicts["part"].isin(_WORTH)]
    texts = [
        f"({three_digits(row.mean)})" if row.low <= 1.0 <= row.high else three_digits(row.mean)
        for row in rows.itertuples()
    ]
    rows = rows.assign(what=rows["part"].map(_WORTH), text=texts)
    titles = {title: title for title in verdicts["title"]}
    return wide(rows, {"what": "With P_o over without, best of each"}, "title", titles)


def plot_pairs(table: pd.DataFrame, ax: Axes) -> None:
    """Draw the ratios of the claims, one row per pair and one marker per family.

    The band holds what counts as equivalent. A hollow marker is a claim that is undecided.
    """
    table = table.dropna(subset="part")
    names, pairs = table["family"].unique(), table[["id", "part"]].drop_duplicates()
    rows = {pair: row for row, pair in enumerate(pairs.itertuples(index=False, name=None))}
    ax.axvspan(1 / EQUIVALENT_WITHIN, EQUIVALENT_WITHIN, color="0.92", linewidth=0)
    ax.axvline(1.0, color="0.6", linewidth=0.6)
    shifts = np.linspace(-0.4, 0.4, len(names) + 2)[1:-1]
    for name, shift, (marker, colour) in zip(names, shifts, cycle(_FAMILIES), strict=False):
        look: style.Look = {"color": colour, "markersize": 4}
        ax.plot([], [], marker, label=escape.figure(family_title(name)), **look)
        for row in table[table["family"] == name].itertuples():
            face = "white" if row.verdict == "undecided" else colour
            arms = [[row.mean - row.low], [row.high - row.mean]]
            ax.errorbar(row.mean, rows[row.id, row.part] + shift, xerr=arms, fmt=marker,
                        linewidth=0.8, markerfacecolor=face, **look)  # fmt: skip
    ax.plot([], [], "o", color="0", markersize=4, markerfacecolor="white", label="undecided")
    ax.set_xscale("log")
    ratios = (0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5)
    ax.set_xticks(ratios, [f"{ratio:g}" for ratio in ratios])
    ax.minorticks_off()
    low = np.nanmin([table["low"].min(), 1 / EQUIVALENT_WITHIN]) / 1.03
    high = np.nanmax([table["high"].max(), EQUIVALENT_WITHIN]) * 1.03
    ax.set_xlim(max(low, 1 / _WIDEST), min(high, _WIDEST))
    # what is measured is on a second line
    labels = [escape.typeset(escape.figure(part), tex=True) for _, part in rows]
    labels = [label.replace(" (", "\n", 1).removesuffix(")") for label in labels]
    ax.set_yticks(range(len(rows)), labels)
    ax.set_ylim(max(len(rows), 1) - 0.5, -0.5)
    ax.tick_params(axis="y", length=0)
    for row in range(1, len(rows)):
        ax.axhline(row - 0.5, color="0.85", linewidth=0.5)
    ax.set_xlabel("Ratio of the errors; below 1 supports the claim")
