"""FPRC and its competitors on a recording: errors on held-out blocks and on a test log."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fprc.competitors import COMPETITORS, base_of, default_settings
from fprc.errors import EvaluationError
from fprc.evaluation.blocks import split_blocks
from fprc.evaluation.crossval import fit_folds, refusals_of
from fprc.evaluation.folds import Fold
from fprc.evaluation.metrics import rmse
from fprc.experiments.data import Data
from fprc.experiments.settings import Judgement
from fprc.models.competitors import build_competitor
from fprc.models.recordings import transform_each

#: Competitors that can be judged on a recording without tuning; the slowest first.
ON_RECORDINGS = (
    "esn", "fprc", "fprc_lowpass", "fuzzy_linear", "ridge_p_o", "bank_p_o", "bank", "plays", "nvar",
)  # fmt: skip
#: Number of blocks, if the recording is long enough.
BLOCKS = 10
#: Shortest block: as many times the purge, and as many time constants of FPRC's low-pass.
PURGES, TIME_CONSTANTS = 2, 3
#: Most numbers in a model's states of one log: 0.5 GB, of which training makes about three copies.
_MOST_NUMBERS = 60_000_000


def recording_blocks(data: Data, judgement: Judgement) -> list[Fold]:
    """Return (training rows, validation rows) of each block of the training log."""
    purge = round(judgement.purge_s / period_s(data))
    time_constant = 1.0 / judgement.models["fprc"]["epsilon"]
    shortest = max(PURGES * purge, round(TIME_CONSTANTS * time_constant))
    return split_blocks(data.lengths, BLOCKS, shortest, purge)


def period_s(data: Data) -> float:
    """Return the mean time from one sample to the next, s."""
    time_s = data.channels["time_s"]
    return float(time_s[-1] - time_s[0]) / (len(time_s) - 1)


def inputs_of(name: str, channels: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the input columns of a model."""
    return np.column_stack([channels[each] for each in COMPETITORS[base_of(name)].inputs])


def judge_competitor(
    name: str, train: Data, test: Data, folds: list[Fold], judgement: Judgement
) -> dict[str, Any]:
    """Return the errors of one competitor with its default settings.

    The features are computed over each whole recording, in the order of time; the blocks select
    rows of them.

    Returns
    -------
    dict
        ``validation_rmse_kpa``, one per block, trained on the others; ``test_rmse_kpa``, trained on
        all of the training log.

    Raises
    ------
    EvaluationError
        A log does not suit the model: it is too short, or too long for the memory.
    """
    settings = default_settings(name, judgement.models)
    _refuse_too_long(name, settings, train, test)
    model = build_competitor(name, settings, judgement.seed)
    y, y_test = (data.channels["p_target_kpa"] for data in (train, test))
    with refusals_of(model):
        features = model.make_features().fit(X := inputs_of(name, train.channels))
        rows = transform_each(features, X, train.lengths)
        errors = fit_folds(model.make_readout(), rows, y, folds).validation_rmse
        readout = model.make_readout().fit(rows, y)
        tested = transform_each(features, inputs_of(name, test.channels), test.lengths)
        return {
            "validation_rmse_kpa": errors,
            "test_rmse_kpa": rmse(y_test, readout.predict(tested)),
        }


def _refuse_too_long(name: str, settings: Mapping[str, Any], *logs: Data) -> None:
    states = settings.get("r", 1)
    samples = max(len(data.channels["time_s"]) for data in logs)
    if states * samples > _MOST_NUMBERS:
        raise EvaluationError(
            f"{name}: its {states} states at {samples} samples need too much memory; at most "
            f"{_MOST_NUMBERS // states} samples, or set models.{name}.r"
        )
