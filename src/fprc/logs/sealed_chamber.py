"""Leak and re-fills of the sealed chamber, separated from the effect of its squeezing."""

from collections.abc import Mapping
from functools import partial
from itertools import accumulate
from typing import Any

import numpy as np

#: Regressors that model the squeezing, functions of its drive (P_i or theta) scaled to 0 to 1:
#: powers, first-order lags, and play operators (Prandtl-Ishlinskii) of these half-widths.
_POWERS, _LAGS_S, _PLAYS = (1, 2, 3), (0.05, 0.2, 1.0, 5.0), (0.02, 0.05, 0.1, 0.2)
#: Smallest step that counts, as a share of the range of P_o.
_STEP_SHARE = 0.065
#: Share of the variance of P_o that the squeezing must explain, after trend and steps are removed.
_EXPLAINED = 0.95
#: Sample rate of the fit, Hz, and most samples: longer recordings use a lower rate.
_SEALED_HZ, _MOST = 20.0, 200_000
#: Channels that may drive the squeezing, the most direct one first.
_SQUEEZES = ("p_i_kpa", "p_i_command_kpa", "theta_deg")
_MAX_STEPS = 50
#: A longer step of the clock, s, is a gap, if the steps are shorter; next to one nothing is judged.
_GAP_S = 0.5
#: In a shorter recording, s, hysteresis that the fit does not model can look like a leak.
SHORT_S = 60.0


def fit_sealed(time_s: np.ndarray, channels: Mapping[str, np.ndarray]) -> dict[str, Any] | None:
    """Fit P_o = squeezing by P_i or theta + slope t + steps, and return slope and steps.

    The squeezing has hysteresis; a model without it would take the loops for steps and trends.
    The fit uses 20 samples per second, fewer in recordings of hours: leaks and re-fills are slow.
    It leaves out gaps in the clock, where the drive is not known.

    Returns
    -------
    dict or None
        ``relative_to``, the driving channel; ``explained``, the share of the variance (without
        trend and steps) that it explains; ``slope_kpa_per_min``, None if that share is too
        small; ``steps``, each with ``at_s`` and ``height_kpa``. None if ``p_o_kpa`` is
        missing or constant, or the recording is shorter than 10 s without its gaps.
    """
    p_o = channels.get("p_o_kpa")
    if p_o is None or np.ptp(p_o) == 0.0 or time_s[-1] - time_s[0] < 10.0:
        return None
    by = next(name for name in _SQUEEZES if name in channels)
    hz = min(_SEALED_HZ, _MOST / (time_s[-1] - time_s[0]))
    grid_s = np.arange(time_s[0], time_s[-1], 1.0 / hz)
    p_o, drive = (np.interp(grid_s, time_s, values) for values in (p_o, channels[by]))
    minutes = (grid_s - grid_s.mean()) / 60.0
    known = ~_in_gaps(grid_s, time_s)
    if known.sum() < 10.0 * hz:
        return None
    basis = [column[known] for column in (np.ones_like(p_o), *_squeezings(drive, hz), minutes)]
    grid_s, p_o, minutes = grid_s[known], p_o[known], minutes[known]
    # a jump across a gap may be the drive's, which is not known there
    resumed = np.flatnonzero(np.diff(grid_s) > 1.5 / hz) + 1

    steps: list[int] = []
    rejected: list[int] = []
    while True:
        weights, residual = _fit(basis, steps, p_o)
        if len(steps) + len(rejected) == _MAX_STEPS:
            break
        jumps = _jumps(residual, [*resumed, *steps, *rejected], hz)
        k = int(np.abs(jumps).argmax())
        scatter = 1.4826 * np.median(np.abs(jumps))
        if abs(jumps[k]) < max(6.0 * scatter, _STEP_SHARE * np.ptp(p_o)):
            break
        height = _fit(basis, [*steps, k], p_o)[0][-1]
        # the slope and the plays absorb part of a step that is not in the fit yet
        is_step = height * jumps[k] > 0.25 * jumps[k] ** 2
        (steps if is_step else rejected).append(k)
    heights = weights[len(basis) :]
    _, unsqueezed = _fit([basis[0], minutes], steps, p_o)
    moves = unsqueezed.var() > 1e-12 * p_o.var()
    explained = float(1.0 - residual.var() / unsqueezed.var()) if moves else 0.0
    if explained < _EXPLAINED:  # not a sealed chamber that the drive squeezes
        return {"relative_to": by, "explained": explained, "slope_kpa_per_min": None, "steps": []}
    return {
        "relative_to": by,
        "explained": explained,
        "slope_kpa_per_min": float(weights[len(basis) - 1]),
        "steps": [
            {"at_s": float(grid_s[k]), "height_kpa": float(height)}
            for k, height in sorted(zip(steps, heights, strict=True))
        ],
    }


def _in_gaps(grid_s: np.ndarray, time_s: np.ndarray) -> np.ndarray:
    """Return which of the times lie in a gap of the clock, or close to one."""
    intervals = np.diff(time_s)
    gaps = np.flatnonzero(intervals > max(_GAP_S, 5.0 * np.median(intervals)))
    begun = np.searchsorted(time_s[gaps] - _GAP_S, grid_s)
    ended = np.searchsorted(time_s[gaps + 1] + _GAP_S, grid_s)
    return begun > ended


def _squeezings(drive: np.ndarray, hz: float) -> list[np.ndarray]:
    # takes half a second to import, and every process that reads a log would do so
    from scipy.signal import lfilter

    if np.ptp(drive) == 0.0:
        return []
    u = (drive - drive.min()) / np.ptp(drive)
    regressors = [u**power for power in _POWERS]
    for lag_s in _LAGS_S:
        share = 1.0 - np.exp(-1.0 / (hz * lag_s))
        regressors.append(lfilter([share], [1.0, share - 1.0], u, zi=[(1.0 - share) * u[0]])[0])
    for width in _PLAYS:
        regressors.append(np.asarray(list(accumulate(u, partial(_play, width=width)))))
    return regressors


def _play(output: float, drive: float, *, width: float) -> float:
    return min(max(output, drive - width), drive + width)


def _fit(
    basis: list[np.ndarray], steps: list[int], values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the least-squares weights, those of the steps last, and the residual."""
    since = np.arange(len(values))
    columns = np.column_stack([*basis, *((since >= k).astype(float) for k in steps)])
    weights, *_ = np.linalg.lstsq(columns, values)
    return weights, values - columns @ weights


def _jumps(residual: np.ndarray, known: list[int], hz: float) -> np.ndarray:
    """Return, for each sample, the mean of the 0.5 s after it minus that of the 0.5 s before."""
    width = max(int(0.5 * hz), 1)
    total = np.concatenate([[0.0], np.cumsum(residual)])
    means = (total[width:] - total[:-width]) / width
    jumps = np.zeros(len(residual))
    jumps[width : len(residual) - width + 1] = means[width:] - means[:-width]
    # the initial states of lags and plays are unknown
    jumps[: int(max(_LAGS_S) * hz)] = 0.0
    for k in known:
        jumps[max(k - 2 * width, 0) : k + 2 * width] = 0.0
    return jumps
