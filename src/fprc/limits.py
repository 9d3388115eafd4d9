"""Limits of numbers: they exclude what a model cannot compute, not what makes a poor model."""

from numbers import Integral, Real
from typing import Any, NamedTuple

#: Largest absolute value of a sample, in any unit. A larger one is a fault: squared and summed
#: it would exceed the range of float, and a low-pass would remember it for hours.
LARGEST = 1e9


class Limit(NamedTuple):
    """Range of a number, in the configuration also of each number of a list; ends are included."""

    low: float
    high: float
    kind: Any = Real  #: Integral for a whole number
    or_none: bool = False
    default: Any = None

    def allows(self, value: Any) -> bool:
        """Return whether ``value`` is a number within."""
        if value is None:
            return self.or_none
        is_number = isinstance(value, self.kind) and not isinstance(value, bool)
        return is_number and self.low <= value <= self.high

    def __str__(self) -> str:  # noqa: D105
        number = "a whole number" if self.kind is Integral else "a number"
        text = f"{number} in [{self.low:.10g}, {self.high:.10g}]"
        return f"{text} or None" if self.or_none else text

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """Set the ends in pydantic's schema of the numbers."""
        schema = inner = handler(source)
        while "schema" in inner:  # below what is checked in other ways
            inner = inner["schema"]
        for number in inner.get("items_schema", [inner]):
            number |= {"ge": self.low, "le": self.high}
        return schema


def Whole(low: int, high: int, default: Any = None, or_none: bool = False) -> Limit:  # noqa: N802
    """Return the range of a whole number."""
    return Limit(low, high, kind=Integral, or_none=or_none, default=default)


#: Of the models' parameters; the defaults are the paper's Table I. W_r of 4,000 nodes takes 128 MB.
MODEL = {
    "n_y": Whole(1, 10_000, 5),
    "n_u": Whole(1, 10_000, 3),
    "epsilon": Limit(1e-9, 1, default=0.01),
    "n_c": Whole(1, 1000, 8),
    "sigma": Limit(1e-9, 1e9, default=2.0),
    "restarts": Whole(1, 10_000, 1),
    "alpha": Limit(0, 1e30, default=1e-3),
    "r": Whole(1, 4000, 800),
    "f_input": Limit(-1e6, 1e6, default=0.02),
    "gamma": Limit(0, 0.999999, default=0.8),
    "rho": Limit(0, 1e6, default=0.4),
    "washout": Whole(0, 10_000, 100),
    "n_references": Whole(0, 1000, or_none=True),
    "n_plays": Whole(1, 10_000),
    "n_taps": Whole(1, 1000),
    "spacing": Whole(1, 10_000),
    "degree": Whole(2, 10),
    "random_state": Whole(0, 2**32 - 1, or_none=True),
}
