"""A claim of the paper: its words, its test, and what bears on it."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from fprc.claims.finding import Results, Statement
from fprc.claims.statements import Printed

#: Kinds of claims that no fit decides: multiplications, and what the simulated rig assumes. It
#: assumes, as the paper does, that the reservoir's bending hardly changes P_o.
COUNTED, ASSUMED = "counted", "assumed"


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
