"""Settings that count samples, scaled to another sample rate so that they mean the same time."""

from collections.abc import Callable, Mapping
from typing import Any

#: Sample rate for which the settings of the paper and of the competitors were chosen, Hz.
PAPER_HZ = 200.0


def scaled(parameters: Mapping[str, Any], ratio: float) -> dict[str, Any]:
    """Return those of a model's parameters that count samples, for another sample rate.

    Low-pass factors, leak rates, the washout and the spacing of taps then mean the same time. The
    number of taps is not among them: fewer than one tap there cannot be. ``ratio`` is the new rate
    over the one that the parameters are for.
    """
    if ratio == 1.0:  # powers would change the last digits
        return {}
    return {
        name: [scale(element, ratio) for element in value]
        if isinstance(value, list)
        else scale(value, ratio)
        for name, value in parameters.items()
        if (scale := _SCALES.get(name))
    }


def settings_at(settings: Mapping[str, Any], rate_hz: float) -> dict[str, Any]:
    """Return the configuration with models for another rate than ``control.sample_rate_hz``."""
    ratio = rate_hz / settings["control"]["sample_rate_hz"]
    models = {
        name: section | scaled(section, ratio)
        for name, section in settings["models"].items()
        if name in ("esn", "fprc")
    }
    return {**settings, "models": {**settings["models"], **models}}


def _lowpass_factor(epsilon: float, ratio: float) -> float:
    # whose step response is the same at the times of both rates
    return 1.0 - (1.0 - epsilon) ** (1.0 / ratio)


def _count(samples: int, ratio: float) -> int:
    return max(round(samples * ratio), min(samples, 1))


_SCALES: dict[str, Callable[[Any, float], Any]] = {
    "epsilon": _lowpass_factor,
    "epsilons": _lowpass_factor,
    "epsilons_p_o": _lowpass_factor,
    "gamma": lambda gamma, ratio: float(gamma ** (1.0 / ratio)),
    "washout": _count,
    "spacing": _count,
}
