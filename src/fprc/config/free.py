"""Ranges of the rig's free parameters."""

from collections.abc import Mapping, Sequence
from typing import Any

from fprc.config.rig import Rig
from fprc.config.section import fields


def free_ranges(
    paths: Sequence[str], narrower: Mapping[str, Sequence[float]]
) -> dict[str, tuple[float, float]]:
    """Return the range of each free parameter, physical unless a narrower one is given.

    Parameters
    ----------
    paths : sequence of str
        As ``fprc.studies.calibration.space.Free`` takes them. The range of a whole list is that of
        its first number.

    Raises
    ------
    ValueError
        Lists every path that is not a number of the rig, and every range that is empty, exceeds
        the physical one, or belongs to no free parameter.
    """
    parameters = {key: (default, field) for key, default, field, _ in fields(Rig())}
    problems = [
        f"calibration.ranges: {path} is not free; remove it or add it to calibration.free"
        for path in narrower
        if path not in paths
    ]
    ranges = {}
    for path in paths:
        if _follows_from_others(path, parameters):
            problems.append(
                f"calibration.free: {path} follows from the other weights, as all sum to 1; "
                "remove it"
            )
        elif (physical := _physical(path, parameters)) is None:
            problems.append(f"calibration.free: {path} is not a number of the rig; remove it")
        else:
            low, high = map(float, narrower.get(path, physical))
            ranges[path] = (low, high)
            if not physical[0] <= low < high <= physical[1]:
                problems.append(
                    f"calibration.ranges: {path} is {low:g} to {high:g}; must rise and lie within "
                    f"{physical[0]:g} to {physical[1]:g}"
                )
    if problems:
        raise ValueError("\n  ".join(problems))
    return ranges


def _physical(path: str, parameters: Mapping[str, tuple[Any, Any]]) -> tuple[float, float] | None:
    key, _, last = path.rpartition(".")
    name = key if last.isdigit() else path
    if name not in parameters:
        return None
    default, field = parameters[name]
    low, high = _limits(field)
    if not isinstance(default, tuple):
        return None if last.isdigit() else (low, high)
    if last.isdigit():
        return (low, high) if int(last) < len(default) else None
    scales = [item / default[0] for item in default]
    return max(low / scale for scale in scales), min(high / scale for scale in scales)


def _follows_from_others(path: str, parameters: Mapping[str, tuple[Any, Any]]) -> bool:
    """Return whether these weights cannot change alone: the last one, or all as a whole."""
    key, _, last = path.rpartition(".")
    name = key if last.isdigit() else path
    if name not in parameters or not name.endswith(".slip_weight"):
        return False
    return not last.isdigit() or int(last) == len(parameters[name][0]) - 1


def _limits(field: Any) -> tuple[float, float]:
    extra = field.json_schema_extra or {}
    if "minimum" in extra:
        return float(extra["minimum"]), float(extra["maximum"])
    bounds = {type(item).__name__: item for item in field.metadata}
    return float(bounds["Ge"].ge), float(bounds["Le"].le)
