"""Reference trajectories, and measures of hysteresis loops."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fprc.errors import EvaluationError

if TYPE_CHECKING:
    from fprc.config.settings import Reference, Signal


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
    """Return pushes like those of a hand, kPa: half sines of random size, duration and time.

    The first push begins at ``quiet_s``, further ones every ``every_s`` on average; each
    lasts 0.2 to 1 s.
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
    a width that grows with frequency.

    Raises
    ------
    EvaluationError
        ``x`` does not cross that level in both directions.
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


def loop_changes(
    time_s: np.ndarray, x: np.ndarray, y: np.ndarray, response: np.ndarray
) -> dict[str, float]:
    """Return how the loop of ``y`` over ``x`` changes over a sweep: last / first quarter.

    Of ``swing``, that of ``response``; of the widths of the loop over the swing of ``y``, at
    quarters of the range of ``x``; and of ``slope``, that of the regression of ``y`` on ``x``. A
    swing is the range of the middle four fifths of the samples: a start from rest and noise
    hardly change it.
    """
    shares = {"width_quarter": 0.25, "width_half": 0.5, "width_three_quarters": 0.75}
    shapes = []
    for part in (time_s < 0.25 * time_s[-1], time_s > 0.75 * time_s[-1]):
        swing, of_response = (np.ptp(np.percentile(v[part], (10.0, 90.0))) for v in (y, response))
        widths = [loop_width(x[part], y[part], share) / swing for share in shares.values()]
        shapes.append([of_response, *widths, np.polyfit(x[part], y[part], 1)[0]])
    first, last = np.array(shapes)
    return dict(zip(("swing", *shares, "slope"), (last / first).tolist(), strict=True))
