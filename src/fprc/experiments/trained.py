"""What a trained model knows of the data that trained it: sample rate, units, and regressors."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fprc.errors import FprcError
from fprc.experiments.data import Data
from fprc.models import SequenceModel
from fprc.registry import entry_of


def trained_on(model: Any, data: Data, name: str, models: Mapping[str, Any] | None = None) -> Any:
    """Return a fitted model that knows the sample rate and the units of the data.

    It remembers the data too if it can learn online.
    """
    model.sample_rate_hz_ = 1.0 / data.period_s
    model.units_ = np.array(data.units(entry_of(name, models).inputs), dtype=object)
    if isinstance(model, SequenceModel) and model.learns_online():
        X, _, lengths = data.samples(name, models)
        return model.remember(X, lengths)
    return model


def refuse_other_data(model: Any, which: str, sample_rate_hz: float, units: Sequence[str]) -> None:
    """Refuse a model that knows to be trained at another rate or in other units, P_exp's first."""
    trained_hz = getattr(model, "sample_rate_hz_", sample_rate_hz)
    if not math.isclose(trained_hz, sample_rate_hz, rel_tol=1e-3):
        raise FprcError(
            f"{which}, was trained at {trained_hz:g} Hz, and control.sample_rate_hz is "
            f"{sample_rate_hz:g}; train it again at this rate, or change the setting"
        )
    trained = list(getattr(model, "units_", units))
    if trained != list(units):
        theirs, ours = (f"{first} from {', '.join(others)}" for first, *others in (trained, units))
        raise FprcError(
            f"{which}, was trained to give {theirs}, and here must give {ours}; train it again on "
            "logs in these units"
        )
