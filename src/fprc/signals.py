"""Reference trajectories, and measures of hysteresis loops and closed-loop runs."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from fprc.errors import EvaluationError
from fprc.paper import LOOPS, REFERENCES

if TYPE_CHECKING:
    from fprc.config.settings import Reference, Signal

Channels = Mapping[str, np.ndarray]

#: Angle up to which the actuator counts as straight, deg.
_STRAIGHT_DEG = 1.0
#: Samples that a part of a swing needs to count: a few say nothing, and may be constant.
_LEG = 20


def chirp(
    t_s: np.ndarray, ends_hz: Sequence[float], duration_s: float, amplitude: float, offset: float
) -> np.ndarray:
    """Return a sine whose frequency rises linearly; it begins at ``offset - amplitude``."""
    first, last = ends_hz
    slope = (last - first) / duration_s
    cycles = t_s * (first + 0.5 * slope * t_s)
    return amplitude * np.sin(2.0 * np.pi * cycles - 0.5 * np.pi) + offset


def multisine(
    t_s: np.ndarray, f_hz: Sequence[float], amplitude: float, offset: float
) -> np.ndarray:
    """Return a sum of sines of equal amplitude; it begins at ``offset - len(f_hz) * amplitude``."""
    phases = 2.0 * np.pi * np.multiply.outer(t_s, np.asarray(f_hz)) - 0.5 * np.pi
    return amplitude * np.sin(phases).sum(axis=-1) + offset


def pressure_command(signal: "Signal", sample_rate_hz: float) -> np.ndarray:
    """Return P_exp of a hysteresis experiment in kPa, one value per sample (Fig. 4)."""
    return _sines(signal, signal.amplitude_kpa, signal.offset_kpa, sample_rate_hz)


def reference_angle(reference: "Reference", sample_rate_hz: float) -> np.ndarray:
    """Return theta_d of a tracking experiment in deg, one value per sample (Sec. IV).

    It begins at its lowest value, which it holds for ``settle_s``.
    """
    moving = _sines(reference, reference.amplitude_deg, reference.offset_deg, sample_rate_hz)
    settling = np.full(round(reference.settle_s * sample_rate_hz), moving[0])
    return np.concatenate([settling, moving])


def _sines(
    shape: "Signal | Reference", amplitude: float, offset: float, sample_rate_hz: float
) -> np.ndarray:
    t_s = np.arange(round(shape.duration_s * sample_rate_hz)) / sample_rate_hz
    if shape.form == "chirp":
        return chirp(t_s, shape.f_hz, shape.duration_s, amplitude, offset)
    return multisine(t_s, shape.f_hz, amplitude, offset)


def random_pushes(
    samples: int, sample_rate_hz: float, *, quiet_s: float, every_s: float, sigma_kpa: float,
    rng: np.random.Generator,
) -> np.ndarray:  # fmt: skip
    """Return pushes like those of a hand, kPa: half sines of random size, of 0.2 to 1 s.

    The first push begins at ``quiet_s``, further ones every ``every_s`` on average.
    """
    t_s = np.arange(samples) / sample_rate_hz
    force, begin = np.zeros(samples), quiet_s
    while begin < t_s[-1]:
        length = rng.uniform(0.2, 1.0)
        phase = (t_s - begin) / length
        inside = (phase >= 0.0) & (phase <= 1.0)
        force[inside] += sigma_kpa * rng.standard_normal() * np.sin(np.pi * phase[inside])
        begin += rng.exponential(every_s)
    return force


def turning_points(x: np.ndarray) -> np.ndarray:
    """Return the indices at which ``x`` turns by more than 5 % of its range."""
    from scipy.signal import find_peaks  # takes half a second to import; only figures need it

    prominence = 0.05 * np.ptp(x) or np.inf
    return np.sort(np.concatenate([find_peaks(side, prominence=prominence)[0] for side in (x, -x)]))


def rms(values: np.ndarray) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def settled(channels: Mapping[str, np.ndarray], settle_s: float) -> dict[str, np.ndarray]:
    """Return the channels of a closed-loop run after its settling time."""
    after = channels["time_s"] >= settle_s
    return {name: values[after] for name, values in channels.items()}


def loop_width(x: np.ndarray, y: np.ndarray, share: float = 0.5) -> float:
    """Return the width of the loop of ``y`` over ``x`` at a share of the range of ``x``.

    ``y`` is interpolated at the crossings: without that, the error of up to one sample would add
    a width that grows with frequency. EvaluationError: ``x`` does not cross that level both ways.
    """
    smooth = np.convolve(np.pad(x, 4, mode="edge"), np.full(9, 1.0 / 9.0), mode="valid")
    away = smooth - (1.0 - share) * x.min() - share * x.max()
    k = np.flatnonzero(np.diff(np.sign(away)) != 0)
    part = away[k] / (away[k] - away[k + 1])
    value = y[k] + part * (y[k + 1] - y[k])
    rising = away[k + 1] > away[k]
    if rising.all() or not rising.any():
        raise EvaluationError(
            f"the width of a loop cannot be measured: in {len(x)} samples the signal does not "
            f"cross {100 * share:.0f} % of its range in both directions; use a longer experiment"
        )
    return float(abs(value[rising].mean() - value[~rising].mean()))


def measure_runs(
    runs: Mapping[str, Channels], unpushed: Channels, quiet_s: float
) -> dict[str, Any]:
    """Return the measures of one seed that the claims about control rest on.

    They are the RMSE of every run, by "reference/controller"; ``effort``, the rms of P_fb over that
    of P_ff; measures of ``sweep`` and ``loops``; and ``disturbance``, what the pushes, the first
    after ``quiet_s``, change of a run that is ``unpushed`` but has the same noise: the rms of
    bending and P_o over their swing, and the ratio of the errors. All runs begin settled.
    """
    effort, loops = {}, {}
    for name in REFERENCES:
        run = runs[f"{name}/fprc_pd"]
        effort[name] = rms(run["p_fb_kpa"]) / rms(run["p_ff_kpa"])
    for name in (f"{reference}/{law}" for reference in LOOPS for law in ("pd", "fprc_pd")):
        theta = runs[name]["theta_deg"]
        width = loop_width(runs[name]["theta_d_deg"], theta)
        loops[name] = {"width_over_span": width / max(float(np.ptp(theta)), 1e-9)}
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
    """Return how the loops of actuator and reservoir change over a sweep: last / first quarter.

    They are the loops of the commanded P_exp and of P_o over theta. Of ``swing``, that of theta or
    P_o; of the widths over the loop's swing, at quarters of the range of theta; and of ``slope``,
    that of the regression on theta. A swing is the range of the middle four fifths of the samples:
    a start from rest and noise hardly change it.
    """
    shares = {"width_quarter": 0.25, "width_half": 0.5, "width_three_quarters": 0.75}
    loops = {"actuator": ("p_exp_command_kpa", "theta_deg"), "reservoir": ("p_o_kpa", "p_o_kpa")}
    time_s, found = sweep["time_s"], {}
    for name, (channel, response) in loops.items():
        shapes = []
        for part in (time_s < 0.25 * time_s[-1], time_s > 0.75 * time_s[-1]):
            x, y, moved = (sweep[k][part] for k in ("theta_deg", channel, response))
            swing, of_response = (np.ptp(np.percentile(v, (10.0, 90.0))) for v in (y, moved))
            widths = [loop_width(x, y, share) / swing for share in shares.values()]
            shapes.append([of_response, *widths, np.polyfit(x, y, 1)[0]])
        first, last = np.array(shapes)
        found[name] = dict(zip(("swing", *shares, "slope"), (last / first).tolist(), strict=True))
    return found


def measure_range(sweep: Channels) -> dict[str, float]:
    """Return the largest angle, the dead zone, and how monotonic the reservoir's response is.

    The dead zone is the median of the commanded P_exp at which the angle rises above
    ``_STRAIGHT_DEG``, over the span of the command. ``monotony`` is the mean rank correlation of
    P_o with theta from turn to turn, without its sign; where the actuator is straight only noise
    moves, and no sample counts.
    """
    from scipy.stats import spearmanr  # takes half a second to import, like the one above

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
