"""Value of the reservoir's readout: FPRC with P_o, without it, and with substitutes for it."""

from dataclasses import replace
from typing import Any

import numpy as np

from fprc.evaluation import evaluate
from fprc.experiments.data import Data
from fprc.experiments.settings import Judgement
from fprc.registry import build

#: P_o and its substitutes, and their models: ``theta`` has the low-pass but no reservoir,
#: ``shifted`` is P_o of another time of the same recording, with its slow changes.
READOUTS = {"none": "fuzzy_linear", "p_o": "fprc", "theta": "fprc_lowpass", "shifted": "fprc"}


def judge_readouts(
    train: Data, test: Data, judgement: Judgement, held_out: str
) -> list[dict[str, Any]]:
    """Return the errors with each readout, first on shuffled folds.

    Parameters
    ----------
    held_out : {"blocked", "recordings"}
        Split that is judged beside ``shuffled``.
    """
    seed = judgement.seed
    logs, moved = (train, test), (shifted(train, seed), shifted(test, seed + 1))
    cells = []
    for split in ("shuffled", held_out):
        folds = replace(judgement, split=split).split_rows(train)
        for readout, name in READOUTS.items():
            samples = (log.samples(name) for log in (moved if readout == "shifted" else logs))
            errors = evaluate(build(name, judgement.models, seed), folds, *samples)
            cells.append({"split": split, "readout": readout, **errors})
    return cells


def shifted(data: Data, seed: int) -> Data:
    """Rotate P_o of each recording by a random time, a quarter to three quarters of its length.

    Samples in a random order would be no control for a P_o that leaks: their mean does not move.
    """
    rng = np.random.default_rng(seed)
    parts = np.split(data.channels["p_o_kpa"], np.cumsum(data.lengths)[:-1])
    rotated = [np.roll(part, int(rng.uniform(0.25, 0.75) * len(part))) for part in parts]
    return data._replace(channels={**data.channels, "p_o_kpa": np.concatenate(rotated)})
