"""Measures of closed-loop runs and hysteresis loops, for claims C13 to C19."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.stats import spearmanr

from fprc.paper import LOOPS, REFERENCES
from fprc.signals import loop_changes, loop_width, rms, turning_points

Channels = Mapping[str, np.ndarray]

#: Angle up to which the actuator counts as straight, deg.
_STRAIGHT_DEG = 1.0
#: Samples that a part of a swing needs to count: a few say nothing, and may be constant.
_LEG = 20


def measure_runs(
    runs: Mapping[str, Channels], unpushed: Channels, quiet_s: float
) -> dict[str, Any]:
    """Return the measures of one seed that the claims about control rest on.

    They are ``rmse_deg`` of every run, by "reference/controller"; ``effort``, the rms of P_fb over
    that of P_ff on each reference; and measures of ``sweep``, ``loops`` and ``disturbance``: what
    the pushes, the first after ``quiet_s``, change of a run that is ``unpushed`` but has the same
    noise, the rms of bending and P_o over their swing, and the ratio of the errors. All runs begin
    after their settling time.
    """
    effort, loops = {}, {}
    for name in REFERENCES:
        run = runs[f"{name}/fprc_pd"]
        effort[name] = rms(run["p_fb_kpa"]) / rms(run["p_ff_kpa"])
    for name in (f"{reference}/{law}" for reference in LOOPS for law in ("pd", "fprc_pd")):
        theta_d, theta = runs[name]["theta_d_deg"], runs[name]["theta_deg"]
        span = max(float(np.ptp(theta)), 1e-9)
        loops[name] = {"width_over_span": loop_width(theta_d, theta) / span}
    run = runs["disturbance/fprc_pd"]
    pushed = run["time_s"] >= quiet_s
    errors = [rms(_error(channels)[pushed]) for channels in (run, unpushed)]
    disturbance = {
        name: rms((run[channel] - unpushed[channel])[pushed]) / float(np.ptp(unpushed[channel]))
        for name, channel in (("bending", "phi_deg"), ("p_o", "p_o_kpa"))
    }
    return {
        "rmse_deg": {name: rms(_error(run)) for name, run in runs.items()},
        "effort": effort,
        "sweep": _sweep(runs["sweep/fprc_pd"]),
        "loops": loops,
        "disturbance": {**disturbance, "error_ratio": errors[0] / errors[1]},
    }


def measure_hysteresis(sweep: Channels) -> dict[str, dict[str, float]]:
    """Return how the loops of actuator and reservoir change over a sweep, see ``loop_changes``.

    Those of the actuator are of the commanded P_exp over theta, and its swing is that of theta.
    """
    time_s, theta, p_o = sweep["time_s"], sweep["theta_deg"], sweep["p_o_kpa"]
    return {
        "actuator": loop_changes(time_s, theta, sweep["p_exp_command_kpa"], theta),
        "reservoir": loop_changes(time_s, theta, p_o, p_o),
    }


def measure_range(sweep: Channels) -> dict[str, float]:
    """Return the largest angle, the dead zone, and how monotonic the reservoir's response is.

    The dead zone is the median over the rises of the angle of the commanded P_exp at which the
    actuator leaves ``_STRAIGHT_DEG``, over the span of the command. ``monotony`` is the mean rank
    correlation of P_o with theta from one turn of theta to the next, without its sign, where the
    actuator is not straight: there noise alone moves.
    """
    theta, command, p_o = (sweep[n] for n in ("theta_deg", "p_exp_command_kpa", "p_o_kpa"))
    rises = np.flatnonzero((theta[:-1] <= _STRAIGHT_DEG) & (theta[1:] > _STRAIGHT_DEG))
    legs = (np.arange(begin, end) for begin, end in pairwise(turning_points(theta)))
    parts = [leg[theta[leg] > _STRAIGHT_DEG] for leg in legs]
    found = [abs(spearmanr(theta[k], p_o[k]).statistic) for k in parts if len(k) >= _LEG]
    return {
        "angle_deg": float(theta.max()),
        "dead_zone": float(np.median(command[rises]) / np.ptp(command)) if len(rises) else 0.0,
        "monotony": float(np.mean(found or [0.0])),
    }


def measure_pressure_error(sweep: Channels) -> dict[str, float]:
    """Return the rms error of each PI controller over the span of its command."""
    found = {}
    for name, channel in (("main", "p_exp"), ("reservoir", "p_i")):
        command, measured = sweep[f"{channel}_command_kpa"], sweep[f"{channel}_kpa"]
        found[name] = rms(command - measured) / float(np.ptp(command))
    return found


def _error(run: Channels) -> np.ndarray:
    return run["theta_d_deg"] - run["theta_deg"]


def _sweep(run: Channels) -> dict[str, float]:
    """Return largest error, its rms in the first and last third, and the lag in the last 10 s."""
    error = _error(run)
    thirds = np.array_split(error, 3)
    period_s = float(np.mean(np.diff(run["time_s"])))
    last = round(10.0 / period_s)
    theta_d, theta = run["theta_d_deg"][-last:], run["theta_deg"][-last:]
    lags = np.arange(-40, 41)
    match = [np.corrcoef(theta_d[40:-40], np.roll(theta, -lag)[40:-40])[0, 1] for lag in lags]
    return {
        "largest_error_deg": float(np.abs(error).max()),
        "lag_ms": float(1000.0 * period_s * lags[int(np.argmax(match))]),
        "first_third_deg": rms(thirds[0]),
        "last_third_deg": rms(thirds[2]),
    }
