"""A claim of the paper, the statements about numbers that test it, and their verdicts."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import reduce
from operator import getitem
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from fprc.intervals import LEVEL, interval_of_mean

REPRODUCED = "reproduced"
NOT_REPRODUCED = "not reproduced"
UNDECIDED = "undecided"
#: Of a claim that holds for almost any numbers, and does here.
NOT_INFORMATIVE = "not informative"

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
    controls: Sequence[Mapping[str, Any]]  #: numbers of ``experiments.measures``
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
        """Return a number of ``fprc.experiments.measures``."""
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
        rows = [
            {
                cell[setting]: np.mean(cell[PHASES[phase]])
                for cell in report[setting]
                if cell["model"] == model
            }
            for report in self.grids
        ]
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
            return tuple(map(math.exp, interval_of_mean(np.log(values), LEVEL)))
        return interval_of_mean(values, LEVEL)

    @property
    def verdict(self) -> str:
        """Reproduced, not reproduced, or undecided."""
        _, first, last = self.interval
        if self.low < first and last < self.high:
            return REPRODUCED
        return NOT_REPRODUCED if last <= self.low or first >= self.high else UNDECIDED

    @property
    def margin(self) -> float:
        """Distance of the interval's nearer end from the limits; negative beyond them."""
        ends = [*self.interval[1:], self.low, self.high]
        if self.ratio:
            ends = [math.log(end) if end > 0 else -math.inf for end in ends]
        first, last, low, high = ends
        return min(first - low, high - last)

    def shown(self, over_rigs: Sequence[float] = ()) -> str:
        """Text, mean, interval, and the range over other rigs."""
        mean, first, last = self.interval
        interval = f" ({first:.3g} to {last:.3g})" if np.size(self.values) > 1 else ""
        rigs = ", rigs {:.3g} to {:.3g}".format(*over_rigs) if over_rigs else ""
        return f"{self.text}: {mean:.3g}{interval}{rigs}"

    def limits(self) -> str:
        """Limits in words."""
        if self.low == -math.inf:
            return f"below {self.high:.3g}"
        if self.high == math.inf:
            return f"above {self.low:.3g}"
        return f"within {self.low:.3g} to {self.high:.3g}"


#: Numbers that the paper prints, ``published.yaml``.
Printed = Mapping[str, Any]


class Claim(NamedTuple):
    """A claim and how it is tested: every statement must hold."""

    id: str
    statements: Callable[[Results, Printed], Iterable[Statement]]
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
