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

    def share_of(self, value: float) -> float:
        """Return where in its range a value lies, 0 to 1; one outside is moved to the end."""
        value = min(max(value, self.low), self.high)
        if self.logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def value_at(self, share: float) -> float:
        """Return the value at a share of the range, with the digits of a rig's file."""
        if self.logarithmic:
            return _rounded(self.low * (self.high / self.low) ** share)
        return _rounded(self.low + share * (self.high - self.low))


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
    """Return the rig's point in the unit cube."""
    return np.array([parameter.share_of(value_at(rig, parameter.path)) for parameter in free])


def decode(point: np.ndarray, rig: Mapping[str, Any], free: Sequence[Free]) -> dict[str, Any]:
    """Return a copy of ``rig`` with its free parameters at ``point``; see ``resolved``.

    The rig that is judged is the rig that is written: numbers have the digits of its file.

    Parameters
    ----------
    point : ndarray of shape (n_parameters,)
        Each parameter as a share of its range, 0 to 1.
    """
    values = [parameter.value_at(share) for parameter, share in zip(free, point, strict=True)]
    return resolved(with_values(rig, [parameter.path for parameter in free], values))


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
        *weights, _ = changed[section]["slip_weight"]
        if (total := sum(weights)) > _MOST:
            weights = [_rounded(weight * _MOST / total) for weight in weights]
        changed[section]["slip_weight"] = [*weights, round(1.0 - sum(weights), 10)]
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


def _place(rig: Mapping[str, Any], path: str) -> tuple[Any, Any]:
    """Return the section or list that holds a number, and its key there."""
    *sections, last = path.split(".")
    holder = reduce(getitem, sections, rig)
    return holder, last if isinstance(holder, Mapping) else int(last)


def _rounded(value: float) -> float:
    return float(f"{value:.4g}") if abs(value) > 1e-12 else 0.0
