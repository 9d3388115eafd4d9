"""A claim of the paper, the statements about numbers that test it, and their verdicts."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from fprc.intervals import LEVEL, interval_of_mean

REPRODUCED = "reproduced"
NOT_REPRODUCED = "not reproduced"
UNDECIDED = "undecided"
#: Of a claim that holds for almost any numbers, and does here.
NOT_INFORMATIVE = "not informative"

#: Kinds of claims that no fit decides: multiplications, and what the simulated rig assumes. It
#: assumes, as the paper does, that the reservoir's bending hardly changes P_o.
COUNTED, ASSUMED = "counted", "assumed"


class Results(NamedTuple):
    """Numbers that the claims are judged on, from result files; sequences have one per seed."""

    replicates: Sequence[Mapping[str, Any]]  #: errors of the models, and weights
    grids: Sequence[Mapping[str, Any]]  #: cells of the grids, by their name
    controls: Sequence[Mapping[str, Any]]  #: numbers of ``experiments.measures``
    times: Mapping[str, Any]
    times_over_n_c: Mapping[str, Any]


class Statement(NamedTuple):
    """A number with limits, measured once per seed.

    The verdict follows from the interval of the mean over seeds: it is undecided if the interval
    contains a limit. A single value has no interval.
    """

    text: str  #: names the number and its unit
    values: np.ndarray  #: one per seed
    low: float = -math.inf
    high: float = math.inf
    ratio: bool = True  #: averaged as logarithms

    @property
    def interval(self) -> tuple[float, float, float]:
        """Mean, and the ends of its 95 % t interval."""
        values = np.log(self.values) if self.ratio else np.asarray(self.values, dtype=float)
        ends = interval_of_mean(values, LEVEL)
        return tuple(map(math.exp, ends)) if self.ratio else ends  # type: ignore[return-value]

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
    text: str
    printed: str  #: what the paper prints
    statements: Callable[[Results, Printed], Sequence[Statement]]
    #: What the values are taken over: seeds of the logs, seeds of the grids, one run.
    over: str = "seeds"
    note: str = ""  #: what a reader must know about the test
    fitted_by: tuple[str, ...] = ()  #: terms of the calibration's objective that decide it
    half_fitted_by: tuple[str, ...] = ()  #: terms that decide a part of it
    kind: str = ""  #: ``COUNTED`` or ``ASSUMED``
    #: Whether it holds for almost any numbers: then only its failure would tell something.
    holds_by_chance: bool = False
    shown_in: tuple[str, ...] = ()  #: tables and figures with the numbers
