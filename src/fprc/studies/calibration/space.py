"""Free parameters of the rig as a point in the unit cube."""

import copy
import math
from collections.abc import Mapping, Sequence
from functools import reduce
from operator import getitem
from typing import Any, NamedTuple

import numpy as np

from fprc.config.rig import LONGEST_LAG_S, free_ranges, squeeze_lag, stiffest_squeeze

#: Largest sum of the slip weights without the last one.
_MOST = 0.97


class Free(NamedTuple):
    """A parameter that the search may change, within its physical range.

    ``path`` names a number ("bending.friction_kpa"), or one of a list
    ("bending.relaxation_time_s.0"). The last of several slip weights cannot be free: it is 1 minus
    the others. A range that spans a decade or more is searched by its logarithm.
    """

    path: str
    low: float
    high: float

    @property
    def logarithmic(self) -> bool:
        """Whether the range is wide enough to be searched by its logarithm."""
        return self.low > 0 and self.high / self.low >= 10.0


def free_parameters(
    paths: Sequence[str], ranges: Mapping[str, Sequence[float]] | None = None
) -> list[Free]:
    """Return the free parameters, each with its range: a narrower one if given, else the physical.

    Raises
    ------
    ValueError
        See ``free_ranges``; in a configuration that was checked, none is raised.
    """
    return [Free(path, *limits) for path, limits in free_ranges(paths, ranges or {}).items()]


def encode(rig: Mapping[str, Any], free: Sequence[Free]) -> np.ndarray:
    """Return the rig's point in the unit cube; a value outside its range is moved to the end."""
    shares = []
    for parameter in free:
        holder, key = _place(rig, parameter.path)
        shares.append(_share(parameter, holder[key]))
    return np.array(shares)


def decode(point: np.ndarray, rig: Mapping[str, Any], free: Sequence[Free]) -> dict[str, Any]:
    """Return a copy of ``rig`` with its free parameters at ``point``.

    Numbers have the digits of a fitted rig's file, so that the rig that is judged is the rig that
    is written.

    Parameters
    ----------
    point : ndarray of shape (n_parameters,)
        Each parameter as a share of its range, 0 to 1.
    """
    changed = copy.deepcopy(dict(rig))
    for share, parameter in zip(point, free, strict=True):
        holder, key = _place(changed, parameter.path)
        holder[key] = _rounded(_value(parameter, float(share)))
    for section in ("bending", "reservoir"):
        if any(parameter.path.startswith(f"{section}.slip_weight.") for parameter in free):
            changed[section]["slip_weight"] = _summing_to_one(changed[section]["slip_weight"])
    return changed


def value_at(rig: Mapping[str, Any], path: str) -> float:
    """Return a number of a rig."""
    holder, key = _place(rig, path)
    return float(holder[key])


def with_values(
    rig: Mapping[str, Any], paths: Sequence[str], values: Sequence[float]
) -> dict[str, Any]:
    """Return a copy of ``rig`` with numbers at paths; the last slip weights follow."""
    changed = copy.deepcopy(dict(rig))
    for path, value in zip(paths, values, strict=True):
        holder, key = _place(changed, path)
        holder[key] = value
    for section in ("bending", "reservoir"):
        changed[section]["slip_weight"] = _summing_to_one(changed[section]["slip_weight"])
    return changed


def resolved(rig: Mapping[str, Any]) -> dict[str, Any]:
    """Return the rig with a damping of the squeeze that its lag and its integration step allow.

    The damping is lowered for the lag, then raised for the step (to a share of 0.48 of the distance
    to equilibrium); where no damping does for both, ``fprc.config.rig.Rig`` refuses the rig.
    """
    reservoir = dict(rig["reservoir"])
    damping = reservoir["squeeze_damping_kpa_s_per_ml"]
    most = damping * LONGEST_LAG_S / squeeze_lag(rig)
    least = rig["step_s"] * stiffest_squeeze(rig) / 0.48
    allowed = max(min(damping, 0.999 * most), least)
    reservoir["squeeze_damping_kpa_s_per_ml"] = float(f"{allowed:.4g}")
    return {**rig, "reservoir": reservoir}


def _summing_to_one(weights: Sequence[float]) -> list[float]:
    """Return weights of which the last is 1 minus the others, whose sum is at most ``_MOST``."""
    *free, _ = weights
    total = sum(free)
    if total > _MOST:
        free = [_rounded(weight * _MOST / total) for weight in free]
    return [*free, round(1.0 - sum(free), 10)]


def _share(parameter: Free, value: float) -> float:
    low, high = parameter.low, parameter.high
    if parameter.logarithmic:
        low, high, value = (
            math.log(low),
            math.log(high),
            math.log(max(value, parameter.low)),
        )
    return min(max((value - low) / (high - low), 0.0), 1.0)


def _value(parameter: Free, share: float) -> float:
    low, high = parameter.low, parameter.high
    if parameter.logarithmic:
        return low * (high / low) ** share
    return low + share * (high - low)


def _place(rig: Mapping[str, Any], path: str) -> tuple[Any, Any]:
    """Return the section or list that holds a number, and its key there."""
    *sections, last = path.split(".")
    holder = reduce(getitem, sections, rig)
    return holder, last if isinstance(holder, Mapping) else int(last)


def _rounded(value: float) -> float:
    return float(f"{value:.4g}") if abs(value) > 1e-12 else 0.0
