"""Ranges of the rig's free parameters."""

from collections.abc import Mapping, Sequence
from functools import cache

from fprc.config.rig import Rig
from fprc.config.section import fields, limits_of


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
    problems = [
        f"calibration.ranges: {path} is not free; remove it or add it to calibration.free"
        for path in narrower
        if path not in paths
    ]
    ranges = {}
    for path in paths:
        if path not in _physical():
            problems.append(
                f"calibration.free: {path} is not a number of the rig, or is a slip weight that "
                "follows from the others, as all sum to 1; remove it"
            )
            continue
        least, most = _physical()[path]
        low, high = map(float, narrower.get(path, (least, most)))
        ranges[path] = (low, high)
        if not least <= low < high <= most:
            problems.append(
                f"calibration.ranges: {path} is {low:g} to {high:g}; must rise and lie within "
                f"{least:g} to {most:g}"
            )
    if problems:
        raise ValueError("\n  ".join(problems))
    return ranges


@cache
def _physical() -> dict[str, tuple[float, float]]:
    """Return the range of each number of the rig, of each list, and of each of its numbers."""
    ranges = {}
    for key, default, field, _ in fields(Rig):
        if (limits := limits_of(field)) is None:
            continue
        numbers = default if isinstance(default, tuple) else ()
        of_each = {f"{key}.{index}": limits for index in range(len(numbers))}
        if key.endswith(".slip_weight"):
            # they sum to 1, so the last one follows, and they cannot be scaled as a whole
            of_each.popitem()
        else:
            scales = [number / numbers[0] for number in numbers] or [1.0]
            low, high = limits
            ranges[key] = (
                max(low / scale for scale in scales),
                min(high / scale for scale in scales),
            )
        ranges |= of_each
    return ranges
