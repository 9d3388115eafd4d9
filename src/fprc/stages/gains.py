"""Gains of closed-loop runs that are already there."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

from fprc.artifacts import write_json
from fprc.errors import LogError
from fprc.logs import read_run
from fprc.logs.isolated import isolated_each

log = logging.getLogger(__name__)

_GAINS = ("kp_kpa_per_deg", "kd_kpa_s_per_deg")


def read_gains(runs: Sequence[str], gains: str) -> None:
    """Collect from closed-loop logs the gains of their PD controllers, by name.

    A gain that the logs do not tell, or of which they tell different values, is
    left out, with a warning.

    Raises
    ------
    LogError
        A log cannot be read, or some are simulated and others are not.
    """
    found: dict[str, list[Any]] = {}
    logs = isolated_each(read_run, runs, names=())
    kinds = {run.attributes["source"]: str(run.path) for run in logs}
    if len(kinds) > 1:
        each = ", ".join(f"{source} ({path})" for source, path in kinds.items())
        raise LogError(f"closed-loop logs of different sources: {each}; use logs of one kind")
    for run in logs:
        name = run.attributes["gain"]
        if name != "none":
            known = found.setdefault(name, [])
            told = gains_told(run.attributes)
            if told not in known:
                known.append(told)
    unclear = [name for name, values in found.items() if len(values) > 1 or not values[0]]
    for name in unclear:
        log.warning("warning: the logs do not agree on one %s gain; it is not given", name)
    first = logs[0].attributes
    write_json(
        gains,
        {
            **{name: values[0] for name, values in found.items() if name not in unclear},
            "candidates": [],
            "source": first["source"],
            "seed": int(first["seed"]),
        },
    )


def gains_told(attributes: Mapping[str, Any]) -> dict[str, float] | None:
    """Return the gains of the PD controller that a closed-loop log names, if it does."""
    told = attributes["rig"].get("gains")
    found = [told.get(key) for key in _GAINS] if isinstance(told, Mapping) else [None]
    if not all(isinstance(value, float | int) for value in found):
        return None
    return dict(zip(_GAINS, map(float, found), strict=True))
