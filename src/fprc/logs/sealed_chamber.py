"""Leak of the sealed chamber, separated from the effect of its squeezing."""

from collections.abc import Mapping
from functools import partial
from itertools import accumulate
from typing import Any

import numpy as np

#: Regressors that model the squeezing, functions of its drive, P_i, scaled to 0 to 1:
#: powers, first-order lags, and play operators (Prandtl-Ishlinskii) of these half-widths.
_POWERS, _LAGS_S, _PLAYS = (1, 2, 3), (0.05, 0.2, 1.0, 5.0), (0.02, 0.05, 0.1, 0.2)
#: Share of the variance of P_o that the squeezing must explain, after the trend is removed.
_EXPLAINED = 0.95
#: Sample rate of the fit, Hz, and most samples: longer recordings use a lower rate.
_SEALED_HZ, _MOST = 20.0, 200_000
#: A longer step of the clock, s, is a gap, if the steps are shorter.
_GAP_S = 0.5
#: In a shorter recording, s, hysteresis that the fit does not model can look like a leak.
SHORT_S = 60.0


def fit_sealed(time_s: np.ndarray, channels: Mapping[str, np.ndarray]) -> dict[str, Any] | None:
    """Fit P_o = squeezing by P_i + slope t, and return the slope.

    The squeezing has hysteresis; a model without it would take the loops for trends. The fit uses
    20 samples per second, fewer in recordings of hours: leaks are slow. It leaves out gaps in the
    clock, where the drive is not known.

    Returns
    -------
    dict or None
        ``explained``, the share of the variance (without
        trend) that it explains; ``slope_kpa_per_min``, None if that share is too small. None if
        ``p_o_kpa`` is missing or constant, or the recording is shorter than 10 s without its gaps.
    """
    p_o, span_s = channels.get("p_o_kpa"), time_s[-1] - time_s[0]
    if p_o is None or np.ptp(p_o) == 0.0 or span_s < 10.0:
        return None
    hz = min(_SEALED_HZ, _MOST / span_s)
    grid_s = np.arange(time_s[0], time_s[-1], 1.0 / hz)
    p_o, drive = (np.interp(grid_s, time_s, values) for values in (p_o, channels["p_i_kpa"]))
    minutes = (grid_s - grid_s.mean()) / 60.0
    basis = np.column_stack([np.ones_like(p_o), *_squeezings(drive, hz), minutes])
    steps_s = np.diff(time_s)
    step_s = steps_s[np.searchsorted(time_s[1:-1], grid_s, side="right")]
    known = step_s <= max(_GAP_S, 5.0 * np.median(steps_s))
    if known.sum() < 10.0 * hz:
        return None
    basis, p_o = basis[known], p_o[known]
    weights, residual = _fit(basis, p_o)
    _, unsqueezed = _fit(basis[:, [0, -1]], p_o)
    moves = unsqueezed.var() > 1e-12 * p_o.var()
    explained = float(1.0 - residual.var() / unsqueezed.var()) if moves else 0.0
    # else it is not a sealed chamber that the drive squeezes
    slope = float(weights[-1]) if explained >= _EXPLAINED else None
    return {"explained": explained, "slope_kpa_per_min": slope}


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


def _fit(basis: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the least-squares weights of the columns, and the residual."""
    weights, *_ = np.linalg.lstsq(basis, values)
    return weights, values - basis @ weights
