"""Reference trajectories as functions of time."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np


def sample_times(duration_s: float, sample_rate_hz: float) -> np.ndarray:
    """Sample instants from 0 up to, not including, ``duration_s``."""
    return np.arange(round(duration_s * sample_rate_hz)) / sample_rate_hz


def chirp(
    t_s: np.ndarray,
    *,
    duration_s: float,
    f_start_hz: float,
    f_end_hz: float,
    amplitude: float,
    offset: float,
) -> np.ndarray:
    """Sine whose frequency rises linearly; it begins at ``offset - amplitude``."""
    slope = (f_end_hz - f_start_hz) / duration_s
    cycles = t_s * (f_start_hz + 0.5 * slope * t_s)
    return amplitude * np.sin(2.0 * np.pi * cycles - 0.5 * np.pi) + offset


def multisine(
    t_s: np.ndarray, *, f_hz: Sequence[float], amplitude: float, offset: float
) -> np.ndarray:
    """Sum of equal sines; it begins at ``offset - len(f_hz) * amplitude``."""
    phases = 2.0 * np.pi * np.multiply.outer(t_s, np.asarray(f_hz)) - 0.5 * np.pi
    return amplitude * np.sin(phases).sum(axis=-1) + offset


def pressure_command(experiment: Mapping[str, Any], sample_rate_hz: float) -> np.ndarray:
    """P_exp of a hysteresis experiment in kPa, one value per sample (Fig. 4)."""
    t_s = sample_times(experiment["duration_s"], sample_rate_hz)
    level = {"amplitude": experiment["amplitude_kpa"], "offset": experiment["offset_kpa"]}
    if experiment["form"] == "chirp":
        span = {key: experiment[key] for key in ("duration_s", "f_start_hz", "f_end_hz")}
        return chirp(t_s, **span, **level)
    return multisine(t_s, f_hz=experiment["f_hz"], **level)
