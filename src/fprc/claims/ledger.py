"""The ledger: claims of the paper as statements about numbers, and their computed verdicts."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import reduce
from operator import getitem
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from fprc.escape import in_words
from fprc.intervals import interval_of_mean

REPRODUCED = "reproduced"
NOT_REPRODUCED = "not reproduced"
UNDECIDED = "undecided"
#: Of a claim that holds for almost any numbers, and does here.
NOT_INFORMATIVE = "not informative"

#: Kinds of claims by what they have to do with the fit of the rig, in the order of readers.
KINDS = {
    "predicted": "no part of it was fitted",
    "half fitted": "a part of it was fitted",
    "fitted": "the simulated rig was fitted to it",
    "assumed": "it is built into the simulated rig",
    "counted": "multiplications a sample, which depend on no rig",
}
#: Terms of the calibration's objective that are not claims.
_TERMS = {
    "tables": "Tables II and III",
    "orders": "their orders",
    "plausible": "plausible loops",
    "open_loop": "open-loop Table IV",
    "closed_loop": "feedback that cuts errors by a fifth",
    "closed_sweep": "the closed-loop error of the sweep",
    "margin": "feedback that helps with gains half again as large",
}
#: Phases as readers see them, and their errors in reports.
PHASES = {
    "training": "train_rmse_kpa",
    "validation": "validation_rmse_kpa",
    "test": "test_rmse_kpa",
}
#: Share of the sizes of taps, smallest first, that count as few, and as many at the other end.
_FEW = 0.3


class Results(NamedTuple):
    """Numbers that the claims are judged on, from result files.

    Sequences have one entry per seed, and so have the arrays, and the rows of the tables, that the
    methods return.
    """

    replicates: Sequence[Mapping[str, Any]]  #: errors of the models, and weights
    grids: Sequence[Mapping[str, Any]]  #: cells of the grids, by their name
    controls: Sequence[Mapping[str, Any]]  #: numbers of ``measure_control``
    times: Mapping[str, Any]
    times_over_n_c: Mapping[str, Any]

    def of_model(
        self, trained_on: str, model: str, key: str, number: Callable[[Any], Any] = np.mean
    ) -> np.ndarray:
        """Return a function of an entry of the reports of a model."""
        reports = [report for replicate in self.replicates for report in replicate["models"]]
        wanted = trained_on, model
        found = [r[key] for r in reports if (r["trained_on"], r["model"]) == wanted]
        return np.array([number(entry) for entry in found])

    def error(self, trained_on: str, model: str, phase: str) -> np.ndarray:
        """Return a model's error, kPa, averaged over the folds."""
        return self.of_model(trained_on, model, PHASES[phase])

    def share(self, feature: str) -> np.ndarray:
        """Return a feature's share of FPRC's weights, averaged over the rules."""
        return np.array([report["weights"]["mean_share"][feature] for report in self.replicates])

    def measured(self, *keys: str) -> np.ndarray:
        """Return a number of the closed loops, of all seeds."""
        return np.array([reduce(getitem, keys, report) for report in self.controls])

    def tracking_error(self, reference: str, controller: str) -> np.ndarray:
        """Return a controller's error on a reference, deg."""
        return self.measured("rmse_deg", f"{reference}/{controller}")

    def multiplications(self, model: str, phase: str, *, over_n_c: bool = False) -> pd.Series:
        """Return how many a model's training or test takes: one value, or one per n_c, rising."""
        wanted = {"model": model, "phase": phase.removesuffix("ing"), "mode": "batch"}
        times = (self.times_over_n_c if over_n_c else self.times)["times"]
        found = [entry for entry in times if wanted.items() <= entry.items()]
        return pd.Series({e.get("n_c", 0): e["multiplications"] for e in found}).sort_index()

    def grid(self, setting: str, model: str, phase: str) -> pd.DataFrame:
        """Return errors, averaged over the folds, by the values of a setting, rising."""
        of_model = ([c for c in report[setting] if c["model"] == model] for report in self.grids)
        rows = ({c[setting]: np.mean(c[PHASES[phase]]) for c in cells} for cells in of_model)
        return pd.DataFrame(rows).sort_index(axis=1)

    def _taps(self, tap: str, phase: str) -> Iterator[pd.DataFrame]:
        """Yield a seed's errors by one tap size, with a column for each size of the other."""
        for report in self.grids:
            cells = {(cell["n_u"], cell["n_y"]): cell[PHASES[phase]] for cell in report["taps"]}
            table = pd.Series({sizes: np.mean(errors) for sizes, errors in cells.items()}).unstack()
            yield table if tap == "n_u" else table.T

    def tap_trend(self, tap: str, phase: str) -> np.ndarray:
        """Return the rank correlation of an error with one tap size, averaged over the other's."""
        ranks = [table.reset_index().rank() for table in self._taps(tap, phase)]
        return np.array([np.corrcoef(rank, rowvar=False)[0, 1:].mean() for rank in ranks])

    def thirds_of_taps(self, tap: str, phase: str) -> np.ndarray:
        """Return the mean errors with few, a medium number of, and many taps."""
        rows = []
        for table in self._taps(tap, phase):
            few = max(round(_FEW * len(table)), 1)
            parts = np.split(table.to_numpy().mean(axis=1), [few, len(table) - few])
            rows.append([part.mean() for part in parts])
        return np.transpose(rows)


class Statement(NamedTuple):
    """A number with limits, measured once per seed.

    The verdict follows from the interval of the mean over seeds: it is undecided if the interval
    contains a limit. A single value has no interval.
    """

    text: str  #: names the number and its unit
    values: Any  #: one per seed
    low: float = -math.inf
    high: float = math.inf
    ratio: bool = True  #: averaged as logarithms

    @property
    def interval(self) -> tuple[float, ...]:
        """Mean, and the ends of its 95 % t interval."""
        values = np.asarray(self.values, dtype=float)
        if self.ratio:
            return tuple(map(math.exp, interval_of_mean(np.log(values))))
        return interval_of_mean(values)

    @property
    def verdict(self) -> str:
        """Reproduced, not reproduced, or undecided."""
        _, first, last = self.interval
        if self.low < first and last < self.high:
            return REPRODUCED
        return NOT_REPRODUCED if last <= self.low or first >= self.high else UNDECIDED

    @property
    def limits(self) -> str:
        """Limits in words."""
        if self.low == -math.inf:
            return f"below {self.high:.3g}"
        if self.high == math.inf:
            return f"above {self.low:.3g}"
        return f"within {self.low:.3g} to {self.high:.3g}"


class Claim(NamedTuple):
    """A claim and how it is tested: every statement must hold."""

    id: str
    statements: Callable[[Results], Iterable[Statement]]
    text: str
    printed: str  #: what the paper prints
    #: What the values are taken over: seeds of the logs, seeds of the grids, one run.
    over: str = "seeds"
    note: str = ""  #: what a reader must know about the test
    fitted_by: Sequence[str] = ()  #: terms of the calibration's objective that decide it
    half_fitted_by: Sequence[str] = ()  #: terms that decide a part of it
    #: Of a claim that no fit decides: ``counted``, or ``assumed`` by the simulated rig, as by the
    #: paper: that the reservoir's bending hardly changes P_o.
    kind: str = ""
    verdict: str = ""  #: that is declared
    #: Whether it holds for almost any numbers: then only its failure would tell something.
    holds_by_chance: bool = False
    shown_in: Sequence[str] = ()  #: tables and figures with the numbers

    def status(self, fitted_to: Iterable[str]) -> str:
        """Return its kind: whether a fit to these terms decides it, in part, or not."""
        to = set(fitted_to)
        if self.kind:
            return self.kind
        if to & set(self.fitted_by):
            return "fitted"
        return "half fitted" if to & set(self.half_fitted_by) else "predicted"


def holding(rows: Sequence[Mapping[str, Any]]) -> dict[str, tuple[int, int]]:
    """Return by kind how many claims are reproduced, of how many that are informative."""
    told = [row for row in rows if row["verdict"] != NOT_INFORMATIVE]
    held = {kind: [r["verdict"] == REPRODUCED for r in told if r["rig"] == kind] for kind in KINDS}
    return {kind: (sum(of_kind), len(of_kind)) for kind, of_kind in held.items() if of_kind}


def terms_in_words(fitted_to: Iterable[str]) -> str:
    """Return what a rig was fitted to, terms of an objective, as a part of a sentence."""
    return in_words(_TERMS.get(term, term) for term in fitted_to) or "nothing"


def judge_claims(
    claims: Sequence[Claim],
    results: Results,
    fitted_to: Iterable[str] = (),
    members: Mapping[str, Any] | None = None,
) -> list[dict[str, Any]]:
    """Return one row per claim, with its verdict and those of its statements.

    A claim is reproduced if every statement is, and not reproduced if one is not. One that almost
    any numbers support, or that no fit decides and that holds on every member, is not informative
    where others would be reproduced. ``members`` is as ``members_of`` returns it.
    """
    rows = []
    known = members or {"of": 0, "holds": {}, "ranges": {}}
    for claim in claims:
        statements, ranges = list(claim.statements(results)), known["ranges"].get(claim.id, {})
        verdicts = {statement.verdict for statement in statements}
        status, held = claim.status(fitted_to), known["holds"].get(claim.id)
        anyway = held == known["of"] and status in ("predicted", "half fitted")
        holds = NOT_INFORMATIVE if claim.holds_by_chance or anyway else REPRODUCED
        weakest = (verdict for verdict in (NOT_REPRODUCED, UNDECIDED) if verdict in verdicts)
        rows.append(
            {
                "id": claim.id,
                "claim": claim.text,
                "published": claim.printed,
                "basis": _basis(claim, results),
                "note": claim.note,
                "verdict": next(weakest, holds),
                "rig": status,
                "rigs": "-" if held is None else f"{held} of {known['of']}",
                "shown_in": list(claim.shown_in),
                "statements": [
                    {
                        "text": statement.text,
                        **dict(zip(("mean", "first", "last"), statement.interval, strict=True)),
                        "over_rigs": ranges.get(statement.text),
                        "limits": statement.limits,
                        "verdict": statement.verdict,
                    }
                    for statement in statements
                ],
            }
        )
    return rows


def members_of(claims: Sequence[Claim], rigs: Sequence[Results]) -> dict[str, Any]:
    """Judge claims on rigs one by one: on how many of them each ``holds``, by claim.

    Also ``of``, the number of rigs, and ``ranges``: the middle 95 % of their means, by claim and
    statement.
    """
    holds, ranges = {}, {}
    for claim in claims:
        judged = [list(claim.statements(rig)) for rig in rigs]
        holds[claim.id] = sum({s.verdict for s in of_rig} == {REPRODUCED} for of_rig in judged)
        means = pd.DataFrame({s.text: s.interval[0] for s in of_rig} for of_rig in judged)
        ends = means.quantile([0.025, 0.975]).map(lambda end: float(f"{end:.4g}"))
        ranges[claim.id] = ends.to_dict("list")
    return {"of": len(rigs), "holds": holds, "ranges": ranges}


def _basis(claim: Claim, results: Results) -> str:
    """Return what the values of a claim are taken over."""
    if claim.over == "one run":
        return "main run"
    of_grids = claim.over != "seeds"
    seeds = len(results.grids if of_grids else results.controls)
    # see fprc.experiments.comparison.evaluate_grids
    folds = ", the first fold of each" if of_grids else ""
    if seeds == 1:
        return f"one seed{folds}"
    if claim.over.startswith("halves"):
        folds += f"; the step is chosen on the first {seeds // 2}"
        seeds -= seeds // 2
    return f"mean and its 95 % interval over {seeds} noise seeds of this rig{folds}"


def changed_verdicts(ledger: Sequence[Mapping[str, str]], declared: dict[str, str]) -> list[str]:
    """Return one line for each claim whose verdict differs from the declared one."""
    ours = {row["id"]: row["verdict"] for row in ledger}
    return [
        f"{name}: {ours.get(name, 'not judged')}, but {declared.get(name, 'nothing')} is declared"
        for name in ours | declared
        if ours.get(name) != declared.get(name)
    ]
