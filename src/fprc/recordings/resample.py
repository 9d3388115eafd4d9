"""Resample a recording to a uniform time grid."""

import math
from collections.abc import Mapping

import numpy as np

from fprc.errors import LogError
from fprc.recordings.clock import rate_of

#: Most samples per channel that resampling may process.
MOST_POINTS = 5_000_000

#: Edges of pass band and stop band, as shares of the new Nyquist frequency.
PASS, STOP = 0.8, 1.0
#: Attenuation in the stop band, dB.
STOP_DB = 70.0
#: Half the length of the low-pass, in new samples (Kaiser's formula).
_HALF_TAPS = (STOP_DB - 7.95) / (2.285 * math.pi * (STOP - PASS)) / 2.0


@np.errstate(all="ignore")  # too many points are refused
def resample(
    time_s: np.ndarray, channels: Mapping[str, np.ndarray], rate_hz: float, path: object = ""
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return times and channels on a uniform grid that begins at the first sample.

    Where the grid coincides with the recording's time stamps, values are copied. Elsewhere they
    are interpolated linearly, which does not overshoot at held values and gaps; a sine of
    f Hz, sampled at s Hz, loses at most (pi f / s)^2 / 2 of its amplitude.

    For a lower rate, values are first interpolated on a grid whose rate is a multiple of the new
    one and at least that of the recording. A linear-phase FIR low-pass, applied without delay, is
    flat up to 0.8 of the new Nyquist frequency and at -70 dB above it; then every n-th sample is
    kept. For the low-pass, the recording is extended by point reflection in each of its end points.

    Raises
    ------
    LogError
        The recording is shorter than a sample, or takes more than ``MOST_POINTS``.
    """
    span_s, ratio = float(time_s[-1] - time_s[0]), rate_of(time_s) / rate_hz
    factor, aligned = 1, False  # how much finer the grid of the low-pass is; 1: there is none
    if 0.0 < ratio < 1e9:  # else the time stamps are nearly equal
        factor = max(round(ratio), 1)
        even_s = time_s[0] + np.arange(len(time_s)) / (factor * rate_hz)
        aligned = bool(np.abs(time_s - even_s).max() <= 1e-3 / (factor * rate_hz))
        if not aligned:
            # up to 1.01 it is the same rate, with clock error; above, where values are
            # interpolated, the grid is twice as fine, so that less is lost
            factor = 1 if ratio <= 1.01 else math.ceil(2.0 * ratio)
    points = factor * (span_s * rate_hz + 2.0 * _HALF_TAPS)
    if not (span_s * rate_hz >= 1.0 and points <= MOST_POINTS and ratio < 1e9):
        k = int(np.argmax(np.diff(time_s)))
        raise LogError(
            f"{path}: {span_s:.4g} s at sample_rate_hz = {rate_hz:g} are {span_s * rate_hz:.4g} "
            f"samples, {points:.2g} while resampled; must be from 1 to {MOST_POINTS:.2g}: check "
            "time.unit, start_s and end_s, and the clock, whose longest step is from "
            f"{time_s[k]:.10g} to {time_s[k + 1]:.10g} s"
        )
    samples = math.floor(span_s * rate_hz + 1e-6) + 1
    fine_s = time_s[0] + np.arange((samples - 1) * factor + 1) / (factor * rate_hz)
    resampled = {}
    for name, values in channels.items():
        fine = values[: len(fine_s)] if aligned else np.interp(fine_s, time_s, values)
        resampled[name] = np.array(fine) if factor == 1 else _lowpass(fine, factor)[::factor]
    return time_s[0] + np.arange(samples) / rate_hz, resampled


def _lowpass(values: np.ndarray, factor: int) -> np.ndarray:
    from scipy.signal import fftconvolve, firwin, kaiser_beta  # slow to import

    half = math.ceil(_HALF_TAPS * factor) + 1
    edge = 0.5 * (PASS + STOP) / factor
    taps = firwin(2 * half + 1, edge, window=("kaiser", kaiser_beta(STOP_DB)))
    padded = np.pad(values, half, mode="reflect", reflect_type="odd")
    return fftconvolve(padded, taps, mode="valid")
