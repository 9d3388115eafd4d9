"""Leak and re-fills of the sealed chamber, told from what squeezes it."""

from collections.abc import Mapping
from functools import partial
from itertools import accumulate
from typing import Any

import numpy as np
from scipy.signal import lfilter

#: What stands for the squeezing of the sealed chamber: powers of P_i (or theta), lags of it,
#: and plays (Prandtl-Ishlinskii) with widths as shares of its range.
_POWERS, _LAGS_S, _PLAYS = (1, 2, 3), (0.05, 0.2, 1.0, 5.0), (0.02, 0.05, 0.1, 0.2)
#: A step is at least this share of the range of P_o.
_STEP_SHARE = 0.065
#: Of the variance of P_o beside trend and steps, what the squeezing must explain.
_EXPLAINED = 0.95
#: Samples a second that are looked at, and most of them: a longer recording has fewer a second.
_SEALED_HZ, _MOST = 20.0, 200_000
#: What may squeeze the chamber, the nearest to it first.
_SQUEEZES = ("p_i_kpa", "p_i_command_kpa", "theta_deg")
_MAX_STEPS = 50


def fit_sealed(time_s: np.ndarray, channels: Mapping[str, np.ndarray]) -> dict[str, Any] | None:
    """Fit P_o = squeezing by P_i or theta + slope t + steps, and return slope and steps.

    Without the hysteresis of the squeezing its loops would pass for steps and
    trends. Work is done on 20 samples a second, in recordings of hours on fewer: leak and
    re-fill are no faster.

    Returns
    -------
    dict or None
        ``relative_to``, the channel that squeezes; ``explained``, the share of the
        variance beside trend and steps that it explains; ``slope_kpa_per_min``, None if
        that is too little; ``steps``, each with ``at_s`` and ``height_kpa``. None without
        ``p_o_kpa``, if it is constant, or in less than 10 s.
    """
    p_o = channels.get("p_o_kpa")
    if p_o is None or np.ptp(p_o) == 0.0 or time_s[-1] - time_s[0] < 10.0:
        return None
    by = next(name for name in _SQUEEZES if name in channels)
    hz = min(_SEALED_HZ, _MOST / (time_s[-1] - time_s[0]))
    grid_s = np.arange(time_s[0], time_s[-1], 1.0 / hz)
    p_o, drive = (np.interp(grid_s, time_s, values) for values in (p_o, channels[by]))
    minutes = (grid_s - grid_s.mean()) / 60.0
    basis = [np.ones_like(p_o), *_squeezings(drive, hz), minutes]

    steps: list[int] = []
    rejected: list[int] = []
    while len(steps) + len(rejected) < _MAX_STEPS:
        weights, rest = _fit(basis, steps, p_o)
        sudden = _sudden(rest, [*steps, *rejected], hz)
        k = int(np.abs(sudden).argmax())
        usual = 1.4826 * np.median(np.abs(sudden))
        if abs(sudden[k]) < max(6.0 * usual, _STEP_SHARE * np.ptp(p_o)):
            break
        height = _fit(basis, [*steps, k], p_o)[0][-1]
        # the slope and the plays take over part of what is not yet accepted as a step
        lasts = height * sudden[k] > 0.25 * sudden[k] ** 2
        (steps if lasts else rejected).append(k)
    weights, rest = _fit(basis, steps, p_o)
    heights = weights[len(basis) :]
    _, unsqueezed = _fit([basis[0], minutes], steps, p_o)
    moves = unsqueezed.var() > 1e-12 * p_o.var()
    explained = float(1.0 - rest.var() / unsqueezed.var()) if moves else 0.0
    if explained < _EXPLAINED:  # not a chamber that this squeezes; a trend would mean nothing
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


def _squeezings(drive: np.ndarray, hz: float) -> list[np.ndarray]:
    if np.ptp(drive) == 0.0:
        return []
    u = (drive - drive.min()) / np.ptp(drive)
    found = [u**power for power in _POWERS]
    for lag_s in _LAGS_S:
        share = 1.0 - np.exp(-1.0 / (hz * lag_s))
        found.append(lfilter([share], [1.0, share - 1.0], u, zi=[(1.0 - share) * u[0]])[0])
    for width in _PLAYS:
        behind = list(accumulate(u, partial(_play, width=width)))
        found.append(np.asarray(behind))
    return found


def _play(behind: float, ahead: float, *, width: float) -> float:
    return min(max(behind, ahead - width), ahead + width)


def _fit(
    basis: list[np.ndarray], steps: list[int], values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the least-squares weights, those of the steps last, and what they leave."""
    since = np.arange(len(values))
    columns = np.column_stack([*basis, *((since >= k).astype(float) for k in steps)])
    weights, *_ = np.linalg.lstsq(columns, values)
    return weights, values - columns @ weights


def _sudden(rest: np.ndarray, known: list[int], hz: float) -> np.ndarray:
    """Return at each sample by how much the next half second differs from the last one."""
    width = max(int(0.5 * hz), 1)
    total = np.concatenate([[0.0], np.cumsum(rest)])
    means = (total[width:] - total[:-width]) / width
    sudden = np.zeros(len(rest))
    sudden[width : len(rest) - width + 1] = means[width:] - means[:-width]
    # where the lags and plays begin is not known
    sudden[: int(max(_LAGS_S) * hz)] = 0.0
    for k in known:
        sudden[max(k - 2 * width, 0) : k + 2 * width] = 0.0
    return sudden
