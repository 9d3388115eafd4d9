"""Settings that count samples, scaled to another sample rate so that they mean the same time."""

from collections.abc import Mapping
from typing import Any

import numpy as np

#: Sample rate for which the settings of the paper and of the competitors were chosen, Hz.
PAPER_HZ = 200.0


def scaled(parameters: Mapping[str, Any], ratio: float) -> dict[str, Any]:
    """Return those of a model's parameters that count samples, for another sample rate.

    Low-pass factors, leak rates, the washout and the spacing of taps then mean the same time. The
    number of taps is not among them: fewer than one tap there cannot be. ``ratio`` is the new rate
    over the one that the parameters are for.
    """
    found: dict[str, Any] = {}
    for name, value in parameters.items() if ratio != 1.0 else ():  # powers change the last digits
        if name in ("epsilon", "epsilons", "epsilons_p_o"):
            # their step responses are the same at the times of both rates
            found[name] = (1.0 - (1.0 - np.asarray(value)) ** (1.0 / ratio)).tolist()
        elif name == "gamma":
            found[name] = float(value ** (1.0 / ratio))
        elif name in ("washout", "spacing"):
            found[name] = max(round(value * ratio), min(value, 1))
    return found


def settings_at(settings: Mapping[str, Any], rate_hz: float) -> dict[str, Any]:
    """Return the configuration with models for another rate than ``control.sample_rate_hz``."""
    ratio, models = rate_hz / settings["control"]["sample_rate_hz"], settings["models"]
    changed = {name: models[name] | scaled(models[name], ratio) for name in ("esn", "fprc")}
    return {**settings, "models": {**models, **changed}}
