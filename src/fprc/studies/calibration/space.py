"""Free parameters of the rig as a point in the unit cube.

``ranges`` are those of ``fprc.config.rig.free_ranges``: by the path of a number
("bending.friction_kpa"), or of one in a list ("bending.relaxation_time_s.0"). The last of several
slip weights is not free: it is 1 minus the others. A range that spans a decade or more is searched
by its logarithm.
"""

import copy
import math
from collections.abc import Mapping
from functools import reduce
from operator import getitem
from typing import Any

import numpy as np

from fprc.config.rig import LONGEST_LAG_S, squeeze_lag, stiffest_squeeze

Ranges = Mapping[str, tuple[float, float]]

#: Largest sum of the slip weights without the last one.
_MOST = 0.97


def encode(rig: Mapping[str, Any], ranges: Ranges) -> np.ndarray:
    """Return a rig's point in the unit cube; a value outside its range is moved to its end."""
    point = []
    for path, (low, high) in ranges.items():
        value = min(max(value_at(rig, path), low), high)
        if _is_wide(low, high):
            point.append(math.log(value / low) / math.log(high / low))
        else:
            point.append((value - low) / (high - low))
    return np.array(point)


def decode(point: np.ndarray, rig: Mapping[str, Any], ranges: Ranges) -> dict[str, Any]:
    """Return a copy of ``rig`` with its free parameters at a point, shares of their ranges.

    The rig that is judged is the rig that is written: numbers have the digits of its file. The
    damping of the squeeze is lowered for its lag, then raised for its integration step (to a share
    of 0.48 of the distance to equilibrium); where no damping does for both, ``Rig`` refuses it.
    """
    values = {}
    for share, (path, (low, high)) in zip(point, ranges.items(), strict=True):
        if _is_wide(low, high):
            values[path] = _rounded(low * (high / low) ** share)
        else:
            values[path] = _rounded(low + share * (high - low))
    found = with_values(rig, values)
    reservoir = found["reservoir"]
    damping = reservoir["squeeze_damping_kpa_s_per_ml"]
    most = damping * LONGEST_LAG_S / squeeze_lag(found)
    least = found["step_s"] * stiffest_squeeze(found) / 0.48
    reservoir["squeeze_damping_kpa_s_per_ml"] = _rounded(max(min(damping, 0.999 * most), least))
    return found


def value_at(rig: Mapping[str, Any], path: str) -> float:
    """Return a number of a rig."""
    holder, key = _place(rig, path)
    return float(holder[key])


def with_values(rig: Mapping[str, Any], values: Mapping[str, float]) -> dict[str, Any]:
    """Return a copy of ``rig`` with numbers at paths; the last slip weights follow."""
    changed = copy.deepcopy(dict(rig))
    for path, value in values.items():
        holder, key = _place(changed, path)
        holder[key] = value
    for section in ("bending", "reservoir"):
        *weights, _ = changed[section]["slip_weight"]
        if (total := sum(weights)) > _MOST:
            weights = [_rounded(weight * _MOST / total) for weight in weights]
        changed[section]["slip_weight"] = [*weights, round(1.0 - sum(weights), 10)]
    return changed


def _place(rig: Mapping[str, Any], path: str) -> tuple[Any, Any]:
    """Return the section or list that holds a number, and its key there."""
    *sections, last = path.split(".")
    holder = reduce(getitem, sections, rig)
    return holder, last if isinstance(holder, Mapping) else int(last)


def _is_wide(low: float, high: float) -> bool:
    return low > 0 and high / low >= 10.0


def _rounded(value: float) -> float:
    return float(f"{value:.4g}") if abs(value) > 1e-12 else 0.0
