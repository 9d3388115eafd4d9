"""FPRC and its competitors on a recording: errors on held-out blocks and on a test log."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fprc.errors import EvaluationError
from fprc.evaluation.crossval import prepare
from fprc.evaluation.folds import Fold, split_blocks
from fprc.experiments.data import Data
from fprc.experiments.settings import Judgement
from fprc.recordings.rates import PAPER_HZ, scaled
from fprc.registry import build, entry_of

#: Control of what P_o is worth: it has P_o of another time, with its slow changes.
SHIFTED = "fprc_shifted"
#: Competitors that can be judged on a recording without tuning; the slowest first.
ON_RECORDINGS = (
    "esn", "fprc", SHIFTED, "fprc_lowpass", "fuzzy_linear", "ridge_p_o", "bank_p_o", "bank",
    "plays", "nvar",
)  # fmt: skip
#: Number of blocks, if the recording is long enough.
BLOCKS = 10
#: Shortest block: as many times the purge, and as many time constants of FPRC's low-pass.
PURGES, TIME_CONSTANTS = 2, 3
#: A block may be shorter by this share: the last sample of a part lies up to one period before its
#: end, and clocks have errors.
_ROUNDING = 0.01
#: Most bytes of a model's features of one log, of which training makes about three copies.
#: Those of the paper's ESN of 75,000 samples.
_MOST_BYTES = 483_000_000


def recording_blocks(data: Data, judgement: Judgement) -> list[Fold]:
    """Return (training rows, validation rows) of each block of the training log."""
    purge = round(judgement.purge_s / data.period_s)
    time_constant = 1.0 / judgement.models["fprc"]["epsilon"]
    shortest = max(PURGES * purge, round(TIME_CONSTANTS * time_constant))
    return split_blocks(data.lengths, BLOCKS, round((1.0 - _ROUNDING) * shortest), purge)


def judge_competitor(
    cell: Mapping[str, Any], *, train: Data, test: Data, judgement: Judgement
) -> dict[str, Any]:
    """Return the errors of one competitor, the ``model`` of the cell, with its default settings.

    Settings that only competitors have are scaled from 200 Hz to the rate of the training log;
    those of ``judgement.models`` are used as they are. The features are computed over each whole
    recording, in the order of time; the blocks select rows of them.

    Returns
    -------
    dict
        ``validation_rmse_kpa``, one per block, trained on the others; ``test_rmse_kpa``, trained on
        all of the training log. Or the ``reason`` why a log does not suit the model: it is too
        short, or too long for the memory.
    """
    name, folds = cell["model"], recording_blocks(train, judgement)
    rate_hz = train.attributes.get("sample_rate_hz", PAPER_HZ)
    settings = scaled(entry_of(name).fixed, rate_hz / PAPER_HZ)
    model = build(name, judgement.models, judgement.seed, **settings)
    if name == SHIFTED:
        train, test = shifted(train, judgement.seed), shifted(test, judgement.seed + 1)
    logs = {key: log.samples(name) for key, log in (("train", train), ("test", test))}
    try:
        prepared = prepare(model, logs, _MOST_BYTES)
        return {
            "validation_rmse_kpa": prepared.cross_validated("train", folds).validation_rmse,
            "test_rmse_kpa": prepared.error(prepared.readout("train"), "test"),
        }
    except EvaluationError as error:
        return {"reason": str(error)}


def shifted(data: Data, seed: int) -> Data:
    """Rotate P_o of each recording by a random time, a quarter to three quarters of its length.

    Samples in a random order would be no control for a P_o that leaks: their mean does not move.
    """
    rng = np.random.default_rng(seed)
    parts = np.split(data.channels["p_o_kpa"], np.cumsum(data.lengths)[:-1])
    rotated = [np.roll(part, int(rng.uniform(0.25, 0.75) * len(part))) for part in parts]
    return data._replace(channels={**data.channels, "p_o_kpa": np.concatenate(rotated)})
