"""Add a simulated reservoir to a recording that has none."""

import logging
from collections.abc import Mapping
from typing import Any

from fprc.errors import LogError
from fprc.experiments.hysteresis import RUNS
from fprc.experiments.reservoir import CHANNELS, commands_of, drive
from fprc.logs import read_raw, write_columns
from fprc.logs.isolated import isolated_each
from fprc.logs.quality import substitute
from fprc.paper import SOURCES

log = logging.getLogger(__name__)

_NOTE = "simulated, driven by the recorded theta"


def add_reservoir(
    raw: str,
    extended: str,
    *,
    experiment: str,
    sample_rate_hz: float,
    rate_tolerance: float,
    zero_deg: float,
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    seed: int,
) -> None:
    """Write a raw log with a simulated reservoir: ``CHANNELS`` are added, or replaced.

    The log's ``source`` ends in ``+sim``, and each of these channels has a note.

    Raises
    ------
    LogError
        The log cannot be used, or its theta needs pressures outside the
        reservoir's range.
    SimulationError
        The simulation diverges.
    """
    (recording,) = isolated_each(
        read_raw,
        [raw],
        experiment=experiment,
        sample_rate_hz=sample_rate_hz,
        rate_tolerance=rate_tolerance,
    )
    source = recording.attributes["source"]
    extended_source = f"{source}+sim"
    if extended_source not in SOURCES:
        raise LogError(
            f"{raw}: source is {source}; a reservoir is simulated only for recorded and imported "
            "logs: set evaluation.reservoir: recorded"
        )
    notes = recording.attributes.get("notes", {})
    if substitute("theta_deg", recording.attributes) is not None:
        raise LogError(
            f"{raw}: channel theta_deg: {notes['theta_deg']}; K_in needs an angle in degrees, so "
            "no reservoir can be simulated: set evaluation.reservoir: recorded, or import an angle"
        )
    theta = recording.channels["theta_deg"]
    commands = commands_of(theta, zero_deg, control, raw)
    simulated = drive(commands, sample_rate_hz, control, rig, seed, RUNS[experiment])
    attributes = recording.attributes | {
        "source": extended_source,
        "simulated": True,
        "seed": seed,
        "notes": notes | dict.fromkeys(CHANNELS, _NOTE),
        "reservoir_zero_deg": zero_deg,
        "reservoir_k_in_kpa_per_deg": control["k_in_kpa_per_deg"],
    }
    write_columns(extended, recording.channels | simulated, attributes)
    log.warning("warning: %s: P_o, P_i and phi are %s", raw, _NOTE)
