"""Say in five points what the reservoir is worth and what to take, from the worlds' numbers."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from fprc.claims.finding import UNDECIDED
from fprc.claims.paired import EQUIVALENT, INFERIOR, NOT_JUDGED, SUPERIOR
from fprc.escape import in_words
from fprc.studies.beyond.worlds import NO_OFFER, measured, title_of

Rows = Sequence[Mapping[str, Any]]
Tables = Sequence[pd.DataFrame]


def advice(worlds: Rows, ledgers: Sequence[Rows], titles: Mapping[str, str]) -> list[str]:
    """Return five points: what P_o changes, when it pays, what else to take, and two warnings.

    A point is one or two sentences.

    Parameters
    ----------
    worlds : sequence of Mapping
        See ``fprc.studies.beyond.worlds``.
    ledgers : sequence
        Of each world, the rows of ``claims.beyond.judge_world``.
    titles : Mapping
        Models by name, as readers see them.
    """
    tables = [measured(world) for world in worlds]
    heads = [ledger[0] for ledger in ledgers]
    rows = {of_claim[0]["id"]: of_claim for of_claim in zip(*ledgers, strict=True)}
    forward = _change(
        "In place of low-passed theta_d, P_o", "FPRC's forward test error", rows["B1"]
    )
    tracking = _change("It", "FPRC's tracking error in open and closed loop", rows["B3"])
    return [
        f"{forward} {tracking}",
        f"{_when_it_pays(rows)} {_second_log(worlds, tables, heads, titles)}".rstrip(),
        _without_second_actuator(tables, heads, titles),
        f"{_tuning(tables, heads)} Against an ESN that was tuned as much, its forward test "
        f"error is {_by_verdict(rows['B6'])}.".lstrip(),
        f"{_if_p_o_falls(tables, heads)} Against Fuzzy-linear, FPRC's error is then "
        f"{_by_verdict(rows['B7'])}.",
    ]


def _change(subject: str, what: str, rows: Rows) -> str:
    """Return by how much P_o lowers or raises an error, and where that is not decided."""
    moved: list[str] = []
    for verdict, verb, sign in ((SUPERIOR, "lowers", -1.0), (INFERIOR, "raises", 1.0)):
        cases = []
        for row in (row for row in rows if row["verdict"] == verdict):
            sizes = [f"{100 * sign * (part['mean'] - 1):.0f} %" for part in row["parts"]]
            cases.append(f"by {in_words(sizes)} on {_place(row)}")
        if cases:
            moved.append(f"{verb} {'it' if moved else what} {', '.join(cases)}")
    words = {
        EQUIVALENT: "it changes by less than 5 %",
        UNDECIDED: "the difference is undecided",
        NOT_JUDGED: "it was not measured",
    }
    done = " and ".join(moved) or f"is not shown to change {what}"
    others = [f"on {places} {words[verdict]}" for verdict, places in _places(rows, words).items()]
    return f"{'; '.join([f'{subject} {done}', *others])}."


def _when_it_pays(rows: Mapping[str, Rows]) -> str:
    compared = list(zip(rows["B1"], rows["B2"], rows["B3"], strict=True))

    def always(verdict: str) -> list[str]:
        return [
            _place(row[0]) for row in compared if {each["verdict"] for each in row} == {verdict}
        ]

    cases = [
        f"{verb} on {in_words(places)}"
        for verb, places in (("pays", always(SUPERIOR)), ("harms", always(INFERIOR)))
        if places
    ]
    decided = len(always(SUPERIOR)) + len(always(INFERIOR))
    if decided < len(compared):
        cases.append(f"is mixed or undecided on {'the others' if decided else 'all these rigs'}")
    return (
        f"Over both tests and tracking, the reservoir {in_words(cases)}; for your rig, record P_o "
        "and run fprc readout."
    )


def _second_log(worlds: Rows, tables: Tables, heads: Rows, titles: Mapping[str, str]) -> str:
    """Return whether a second training log does as much as P_o, where that was measured."""
    models = ["fprc_lowpass", "fprc"]
    for world, table, head in zip(worlds, tables, heads, strict=True):
        logs = {
            entry["seed"]: {name: own["test_rmse_kpa"] for name, own in entry["models"].items()}
            for entry in world.get("training_length") or ()
            if entry.get("two_logs")
        }
        two = pd.DataFrame(logs.values()).reindex(columns=models).mean()
        one = _means(table[table["seed"].isin(list(logs))], "forward").reindex(models)
        if two.notna().all() and one.notna().all():
            verb = "does as much as" if two["fprc_lowpass"] <= one["fprc"] else "does less than"
            changes = ", and ".join(
                f"{title_of(name, titles)} from {one[name]:.1f} to {two[name]:.1f} kPa"
                for name in models
            )
            return (
                "One table, without a registered claim, suggests that a second training log that "
                f"resembles the test log {verb} P_o: on {_place(head)} it brings {changes}."
            )
    return ""


def _without_second_actuator(tables: Tables, heads: Rows, titles: Mapping[str, str]) -> str:
    """Return the models without P_o that have the lowest errors, with their worlds."""
    texts = []
    for measure, unit, words in (
        ("open_loop", "deg", "tracking error in open loop"),
        ("forward", "kPa", "forward test error"),
    ):
        best: dict[str, list[str]] = {}
        for table, head in zip(tables, heads, strict=True):
            readers = table[table["measure"].str.startswith("shifted/")]["model"]
            offered = ~table["model"].isin(readers) & ~table["model"].str.endswith(NO_OFFER)
            means = _means(table[offered], measure)
            if len(means):
                case = f"{head['title']} {means.min():#.3g}"
                best.setdefault(title_of(str(means.idxmin()), titles), []).append(case)
        if best:
            models = " or ".join(
                f"{name} ({', '.join(each)} {unit})" for name, each in best.items()
            )
            texts.append(f"or the lowest {words} take {models}.")
    if not texts:
        return "No model was measured."
    return " ".join(
        [f"Without a second actuator, f{texts[0]}", *(f"F{text}" for text in texts[1:])]
    )


def _tuning(tables: Tables, heads: Rows) -> str:
    """Return the least and the greatest change by settings that the training log has chosen."""
    forward, tracking = (
        [
            (ratio, f"{100 * (ratio - 1):+.0f} % ({head['title']})")
            for table, head in zip(tables, heads, strict=True)
            if (ratio := _mean_ratio(table, measure)) is not None
        ]
        for measure in ("forward", "open_loop")
    )
    if not forward:
        return ""
    changes = [f"its forward test error by {_span(forward)}"]
    if tracking:
        changes.append(f"its tracking error in open loop by {_span(tracking)}")
    misleads = "misleads: it " if min(forward)[0] > 1.0 else ""
    return (
        "Choosing FPRC's settings by cross-validation inside the training log "
        f"{misleads}changes {' and '.join(changes)}."
    )


def _span(ratios: Sequence[tuple[float, str]]) -> str:
    return " to ".join(text for _, text in dict.fromkeys((min(ratios), max(ratios))))


def _if_p_o_falls(tables: Tables, heads: Rows) -> str:
    text = "Check P_o before each run: a leak or a few kelvin of cooling can lower it by 2 kPa"
    for table, head in zip(tables, heads, strict=True):
        before, after = _means(table, "forward"), _means(table, "shifted/-2")
        if {"fprc", "fuzzy_linear"} <= set(before.index) and "fprc" in after:
            return (
                f"{text}, and on {_place(head)} FPRC's forward test error then goes from "
                f"{before['fprc']:.1f} to {after['fprc']:.1f} kPa (Fuzzy-linear, which needs no "
                f"P_o: {before['fuzzy_linear']:.1f} kPa)."
            )
    return f"{text}."


def _means(table: pd.DataFrame, measure: str) -> pd.Series:
    """Return the mean of a measure over units, by model; those that lack a build are left out."""
    own = table[table["measure"] == measure]
    values = own.pivot_table(index=["unit", "seed"], columns="model", values="value")
    return values.dropna(axis="columns").groupby(level="unit").mean().mean()


def _mean_ratio(table: pd.DataFrame, measure: str) -> float | None:
    """Return the geometric mean over builds of tuned FPRC's error over FPRC's."""
    own = table[table["measure"] == measure]
    values = own.pivot_table(index=["unit", "seed"], columns="model", values="value")
    if not {"fprc", "fprc_tuned"} <= set(values):
        return None
    return float(np.exp(np.log(values["fprc_tuned"] / values["fprc"]).mean()))


def _by_verdict(rows: Rows) -> str:
    """Return where an error is lower, equal, higher, undecided or unmeasured."""
    words = {
        SUPERIOR: "lower",
        EQUIVALENT: "equal within 5 %",
        INFERIOR: "higher",
        UNDECIDED: "undecided",
        NOT_JUDGED: "unmeasured",
    }
    found = _places(rows, words)
    return ", ".join(f"{words[verdict]} on {places}" for verdict, places in found.items())


def _places(rows: Rows, verdicts: Iterable[str]) -> dict[str, str]:
    """Return the places of each verdict that occurs."""
    by_verdict = {
        verdict: [_place(row) for row in rows if row["verdict"] == verdict] for verdict in verdicts
    }
    found = {verdict: in_words(places) for verdict, places in by_verdict.items() if places}
    if found:
        last = list(found)[-1]
        if len(by_verdict[last]) == len(rows):
            found[last] = "all these rigs"
        elif len(by_verdict[last]) > 1:
            found[last] = "the others"
    return found


def _place(row: Mapping[str, Any]) -> str:
    return f"the {row['title']} rig{'s' if row['unit'] == 'rig' else ''}"
