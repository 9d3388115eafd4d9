"""Say in five points what the reservoir is worth and what to take, from the worlds' numbers."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from fprc.claims.finding import LEVEL, UNDECIDED, interval_of_mean
from fprc.claims.paired import EQUIVALENT, INFERIOR, NOT_JUDGED, SUPERIOR
from fprc.worlds import measured, title_of

#: What makes the loops of a rig, by the name of its world.
LOOPS = {
    "dry": "dry friction, Maxwell slip",
    "bouc_wen": "dry friction, Bouc-Wen",
    "viscous": "a viscous memory",
}

#: Settings that were chosen for a comparison, and are no model to take.
_NO_OFFER = ("_oracle", "_matched")

Ledger = Sequence[Mapping[str, Any]]
Row = Mapping[str, Any]


def advice(
    worlds: Sequence[Mapping[str, Any]], ledgers: Sequence[Ledger], titles: Mapping[str, str]
) -> list[str]:
    """Return what P_o is worth in test error, in tracking, what to take, and two warnings.

    Parameters
    ----------
    worlds : sequence of Mapping
        See ``fprc.worlds``. What makes the loops of the rigs in ``LOOPS`` is said.
    ledgers : sequence
        Of each world, the rows of ``claims.beyond.judge_world``.
    titles : Mapping
        Models by name, as readers see them.
    """
    by_claim = [{row["id"]: row for row in ledger} for ledger in ledgers]
    tables = [measured(world) for world in worlds]
    named = [
        f"{world['title']} ({LOOPS[world['name']]})" if world["name"] in LOOPS else world["title"]
        for world in worlds
    ]
    two_logs = [_with_two_logs(world, titles) for world in worlds]
    forward = _worth("FPRC's forward test error", "B1", by_claim, named)
    return [
        " ".join([forward, *filter(None, two_logs)]),
        _worth("FPRC's tracking error, open and closed loop,", "B3", by_claim, named),
        _what_to_take(worlds, tables, titles),
        _of_readout_and_tuning(worlds, tables, by_claim),
        _if_p_o_falls(worlds, tables, by_claim),
    ]


def _worth(what: str, claim: str, by_claim: Sequence[Mapping[str, Row]], named: list[str]) -> str:
    """Return what P_o changes against low-passed theta, by verdict and world."""
    groups: dict[str, list[str]] = {}
    for rows, name in zip(by_claim, named, strict=True):
        row = rows[claim]
        verdict = str(row["verdict"])
        kind = {SUPERIOR: "lower", INFERIOR: "higher"}.get(verdict, verdict)
        changes = " and ".join(_percent(part["mean"], kind) for part in row["parts"])
        groups.setdefault(kind, []).append(f"{name}{f': {changes}' if changes else ''}")
    kinds = {
        "lower": "lower on",
        "higher": "higher on",
        EQUIVALENT: "the same within 5 % on",
        UNDECIDED: "not decided on",
        NOT_JUDGED: "not measured on",
    }
    texts = [
        f"{words} {'; '.join(groups[kind])}" for kind, words in kinds.items() if kind in groups
    ]
    return f"With P_o instead of low-passed theta {what} is {'. It is '.join(texts)}."


def _percent(ratio: float, kind: str) -> str:
    percent = 100.0 * (ratio - 1.0)
    if kind in ("lower", "higher"):
        return f"{abs(percent):.0f} %"
    return f"{percent:+.0f} %" if abs(percent) >= 0.5 else "0 %"


def _what_to_take(
    worlds: Sequence[Mapping[str, Any]], tables: Sequence[pd.DataFrame], titles: Mapping[str, str]
) -> str:
    texts = []
    for world, table in zip(worlds, tables, strict=True):
        if world["name"] not in LOOPS:
            continue
        offered = table[~table["model"].str.endswith(_NO_OFFER)]
        readers = set(table[table["measure"].str.startswith("shifted/")]["model"])
        found = [
            f"{words} {best}"
            for measure, words, unit in (
                ("open_loop", "the lowest tracking error in open loop is that of", "deg"),
                ("forward", "the lowest forward test error that of", "kPa"),
            )
            if (best := _best(offered, measure, unit, readers, titles))
        ]
        if found:
            texts.append(f"On {world['title']} {', and '.join(found)}.")
    return " ".join(texts) or "No model was measured."


def _best(
    table: pd.DataFrame, measure: str, unit: str, readers: set[str], titles: Mapping[str, str]
) -> str:
    """Return the best model with all that equal it, and the best one without a second actuator."""
    own = table[table["measure"] == measure]
    if own.empty:
        return ""
    values = own.pivot_table(index=["unit", "seed"], columns="model", values="value")
    means = values.mean().sort_values()

    def shown(names: Sequence[str]) -> str:
        return ", ".join(f"{title_of(n, titles)} ({means[n]:.3g} {unit})" for n in names)

    text = shown(_not_worse(values[list(means.index)]))
    without = [name for name in means.index if name not in readers]
    if without and means.index[0] in readers:
        text += f" (without a second actuator {shown(without[:1])})"
    return text


def _not_worse(values: pd.DataFrame) -> list[str]:
    """Return the first column and those whose paired ratio to it is not above 1 with confidence."""
    first = values.iloc[:, 0]
    names = [str(values.columns[0])]
    for name in values.columns[1:]:
        ratios = np.log((values[name] / first).dropna()).groupby(level="unit").mean().to_numpy()
        if ratios.size > 1 and interval_of_mean(ratios, LEVEL)[1] <= 0.0:
            names.append(str(name))
    return names


def _with_two_logs(world: Mapping[str, Any], titles: Mapping[str, str]) -> str:
    """Return what P_o is worth after training on two logs, if that was measured."""
    errors = pd.DataFrame(
        {name: own["test_rmse_kpa"] for name, own in entry["models"].items()}
        for entry in world.get("training_length") or ()
        if entry.get("two_logs")
    ).mean()
    if not {"fprc", "fprc_lowpass"} <= set(errors.index):
        return ""
    best = str(errors.idxmin())
    return (
        f"Trained on a second log too, which resembles the test log, it is {errors['fprc']:.1f} "
        f"kPa with P_o and {errors['fprc_lowpass']:.1f} kPa with low-passed theta on "
        f"{world['title']}; the lowest error is then that of {title_of(best, titles)}, "
        f"{errors[best]:.1f} kPa."
    )


def _of_readout_and_tuning(
    worlds: Sequence[Mapping[str, Any]],
    tables: Sequence[pd.DataFrame],
    by_claim: Sequence[Mapping[str, Row]],
) -> str:
    chosen = [
        f"{_percent(ratio, '')} on {world['title']}"
        for world, table in zip(worlds, tables, strict=True)
        if (ratio := _mean_ratio(table, "fprc_tuned", "fprc")) is not None
    ]
    text = (
        f"FPRC's fuzzy readout against a ridge on the same features: {_by_world('B4', by_claim)}. "
        f"Tuned FPRC against an ESN that was tuned as much: {_by_world('B6', by_claim)}."
    )
    if chosen:
        text += (
            " Tuning means cross-validation inside the training log, which changes FPRC's test "
            f"error by {', '.join(chosen)}: it does not choose well for another motion."
        )
    return text


def _if_p_o_falls(
    worlds: Sequence[Mapping[str, Any]],
    tables: Sequence[pd.DataFrame],
    by_claim: Sequence[Mapping[str, Row]],
) -> str:
    text = (
        "If P_o falls by 2 kPa after training, as by a leak or a few kelvin of cooling, FPRC "
        f"against Fuzzy-linear: {_by_world('B7', by_claim)}."
    )
    for world, table in zip(worlds, tables, strict=True):
        means = table.groupby(["model", "measure"])["value"].mean()
        wanted = [("fprc", "forward"), ("fprc", "shifted/-2"), ("fuzzy_linear", "forward")]
        if all(key in means.index for key in wanted):
            before, after, other = (means[key] for key in wanted)
            return (
                f"{text} On {world['title']} its test error rises from {before:.1f} to "
                f"{after:.1f} kPa; Fuzzy-linear, which needs no P_o, has {other:.1f} kPa."
            )
    return text


def _mean_ratio(table: pd.DataFrame, ours: str, theirs: str) -> float | None:
    """Return the geometric mean over builds of the ratio of two forward test errors."""
    own = table[table["measure"] == "forward"]
    values = own.pivot_table(index=["unit", "seed"], columns="model", values="value")
    if not {ours, theirs} <= set(values):
        return None
    return float(np.exp(np.log(values[ours] / values[theirs]).mean()))


_VERDICTS: Mapping[str, Callable[[str], str]] = {
    SUPERIOR: "better on {}".format,
    EQUIVALENT: "equal within 5 % on {}".format,
    INFERIOR: "worse on {}".format,
    UNDECIDED: "undecided on {}".format,
    NOT_JUDGED: "not measured on {}".format,
}


def _by_world(claim: str, by_claim: Sequence[Mapping[str, Row]]) -> str:
    """Return the verdict on a claim in each world."""
    texts = [
        words(_listed(titles))
        for verdict, words in _VERDICTS.items()
        if (titles := [r[claim]["title"] for r in by_claim if r[claim]["verdict"] == verdict])
    ]
    return ", ".join(texts)


def _listed(names: Sequence[str]) -> str:
    *others, last = names
    return f"{', '.join(others)} and {last}" if others else last
