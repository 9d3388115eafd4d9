"""Say in five sentences what an engineer should take, from the verdicts on B1-B8."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.claims.finding import UNDECIDED
from fprc.claims.paired import EQUIVALENT, INFERIOR, NOT_JUDGED, SUPERIOR
from fprc.worlds import measured, title_of

#: What makes the loops of a rig, by the name of its world.
LOOPS = {"dry": "dry friction", "viscous": "a viscous memory"}

Ledger = Sequence[Mapping[str, Any]]


def advice(
    worlds: Sequence[Mapping[str, Any]], ledgers: Sequence[Ledger], titles: Mapping[str, str]
) -> list[str]:
    """Return sentences on what makes the loops, when P_o pays, and what to take.

    Parameters
    ----------
    worlds : sequence of Mapping
        See ``fprc.worlds``. Those named dry and viscous are compared.
    ledgers : sequence
        Of each world, the rows of ``claims.beyond.judge_world``.
    titles : Mapping
        Models by name, as readers see them.
    """
    by_claim = [{row["id"]: row for row in ledger} for ledger in ledgers]
    of_loops = {
        world["name"]: rows
        for world, rows in zip(worlds, by_claim, strict=True)
        if world["name"] in LOOPS
    }
    return [
        _what_makes_the_loops(of_loops),
        _when_it_pays(by_claim),
        _what_to_take(worlds, titles),
        _of_readout_and_esn(by_claim),
        _if_p_o_shifts(by_claim),
    ]


def _what_makes_the_loops(of_loops: Mapping[str, Mapping[str, Any]]) -> str:
    if not of_loops:
        return "Neither a rig with dry friction nor one with a viscous memory was run."
    found = "; ".join(
        f"with {LOOPS[name]}, {_effect(rows['B1'])}" for name, rows in of_loops.items()
    )
    if len(of_loops) == 1:
        return f"{found[:1].upper()}{found[1:]}; loops of another kind were not run."
    if len({rows["B1"]["verdict"] for rows in of_loops.values()}) == 1:
        return f"The worth of P_o does not depend on what makes the loops: {found}."
    return f"The worth of P_o depends on what makes the loops: {found}."


def _effect(row: Mapping[str, Any]) -> str:
    """Return what P_o does to the forward test error."""
    if row["verdict"] == NOT_JUDGED:
        return "P_o was not compared with a low-pass of theta_d"
    percent = 100.0 * (row["parts"][0]["mean"] - 1.0)
    what = {
        SUPERIOR: f"P_o gives FPRC {-percent:.0f} % less test error than",
        EQUIVALENT: "P_o gives FPRC the same test error, within 5 %, as",
        INFERIOR: f"P_o gives FPRC {percent:.0f} % more test error than",
        UNDECIDED: f"it is undecided whether P_o gives FPRC less test error ({_signed(percent)} %) "
        "than",
    }[row["verdict"]]
    return f"{what} a low-pass of theta_d"


def _signed(percent: float) -> str:
    return f"{percent:+.0f}" if abs(percent) >= 0.5 else "0"


def _when_it_pays(by_claim: Sequence[Mapping[str, Any]]) -> str:
    places: dict[str, list[str]] = {}
    for rows in by_claim:
        verdicts = {rows[claim]["verdict"] for claim in ("B1", "B3")}
        if verdicts == {SUPERIOR}:
            kind = "improves both test error and tracking"
        elif verdicts <= {EQUIVALENT, INFERIOR}:
            kind = "improves neither"
        elif verdicts <= {SUPERIOR, EQUIVALENT, INFERIOR}:
            kind = "improves only one of the two"
        else:
            kind = "has an undecided effect on one or both"
        places.setdefault(kind, []).append(rows["B1"]["title"])
    return f"A second actuator as a reservoir {_placed(places, len(by_claim))}."


def _what_to_take(worlds: Sequence[Mapping[str, Any]], titles: Mapping[str, str]) -> str:
    texts = []
    for world in worlds:
        table = measured(world)
        table = table[~table["model"].str.endswith(("_oracle", "_matched"))]
        readers = set(table[table["measure"].str.startswith("shifted/")]["model"])
        means = table.groupby(["measure", "model"])["value"].mean()
        if world["name"] not in LOOPS or "forward" not in means:
            continue
        best, without = (
            means["forward"].drop(list(left_out), errors="ignore").idxmin()
            for left_out in ((), readers)
        )
        text = (
            f"with {LOOPS[world['name']]} the lowest mean test error is that of "
            f"{_model(best, means, titles)}"
        )
        if best != without:
            text += f" or, without a second actuator, of {_model(without, means, titles)}"
        texts.append(text)
    if not texts:
        return "No model can be recommended, since none was measured."
    text = "; ".join(texts)
    more = [_with_two_logs(world, titles) for world in worlds]
    return " ".join([f"{text[:1].upper()}{text[1:]}.", *filter(None, more)])


def _with_two_logs(world: Mapping[str, Any], titles: Mapping[str, str]) -> str:
    """Return what P_o is worth after training on two logs, if that was measured."""
    errors = pd.DataFrame(
        {name: own["test_rmse_kpa"] for name, own in entry["models"].items()}
        for entry in world.get("training_length") or ()
        if entry.get("two_logs")
    ).mean()
    if not {"fprc", "fprc_lowpass"} <= set(errors.index):
        return ""
    best = errors.drop([name for name in errors.index if name.endswith("_tuned")]).idxmin()
    return (
        f"On {world['title']}, trained on a second log too, which resembles the test log, FPRC "
        f"has {errors['fprc']:.1f} kPa with P_o and {errors['fprc_lowpass']:.1f} kPa with a "
        f"low-pass of theta_d; the lowest is {title_of(str(best), titles)} with "
        f"{errors[best]:.1f} kPa."
    )


def _model(name: str, means: pd.Series, titles: Mapping[str, str]) -> str:
    numbers = f"{means['forward', name]:.1f} kPa"
    if ("open_loop", name) in means:
        numbers += f", {means['open_loop', name]:.2f} deg in open loop"
    return f"{title_of(name, titles)} ({numbers})"


def _of_readout_and_esn(by_claim: Sequence[Mapping[str, Any]]) -> str:
    fuzzy = _against("a ridge on the same features", "B4", by_claim)
    tuned = _against("an ESN that was tuned as much", "B6", by_claim)
    return f"FPRC's fuzzy readout {fuzzy}, while FPRC {tuned}."


def _if_p_o_shifts(by_claim: Sequence[Mapping[str, Any]]) -> str:
    shifted = _against("Fuzzy-linear", "B7", by_claim)
    return f"If P_o falls by 2 kPa after training, as by a leak or a few kelvin, FPRC {shifted}."


_VERBS = {
    SUPERIOR: "beats {}",
    EQUIVALENT: "equals {} within 5 %",
    INFERIOR: "loses to {}",
    UNDECIDED: "is undecided against {}",
    NOT_JUDGED: "was not compared with {}",
}


def _against(other: str, claim: str, by_claim: Sequence[Mapping[str, Any]]) -> str:
    """Return in which worlds a model has which verdict against another."""
    places: dict[str, list[str]] = {}
    for rows in by_claim:
        name = (
            other if not places or _VERBS[rows[claim]["verdict"]].format(other) in places else "it"
        )
        places.setdefault(_VERBS[rows[claim]["verdict"]].format(name), []).append(
            rows[claim]["title"]
        )
    return _placed(places, len(by_claim))


def _placed(places: Mapping[str, Sequence[str]], worlds: int) -> str:
    """Return what happens, and in which worlds."""
    texts = [
        f"{what} {'everywhere' if len(names) == worlds else f'on {_listed(names)}'}"
        for what, names in places.items()
    ]
    return ", but ".join(filter(None, [", ".join(texts[:-1]), texts[-1]]))


def _listed(names: Sequence[str]) -> str:
    *others, last = names
    return f"{', '.join(others)} and {last}" if others else last
