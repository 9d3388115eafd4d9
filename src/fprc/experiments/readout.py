"""Value of the reservoir's readout: FPRC with P_o, without it, and with substitutes for it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fprc.experiments.data import Data
from fprc.experiments.grids import judge_cell
from fprc.experiments.settings import Judgement

#: P_o and its substitutes, and their models: ``theta`` has the low-pass but no reservoir,
#: ``shifted`` is P_o of another time of the same recording, with its slow changes.
READOUTS = {"none": "fuzzy_linear", "p_o": "fprc", "theta": "fprc_lowpass", "shifted": "fprc"}


def readout_cells(
    models: Mapping[str, Any], epsilon: Sequence[float], n_u: Sequence[int], held_out: str
) -> list[dict[str, Any]]:
    """Return the cells: each readout at the models' settings, and over epsilon and n_u.

    Parameters
    ----------
    held_out : {"blocked", "recordings"}
        Split that is judged beside ``shuffled``.
    """
    chosen = models["fprc"]["epsilon"], models["fprc"]["n_u"]
    pairs = [
        chosen,
        *((value, chosen[1]) for value in epsilon),
        *((chosen[0], value) for value in n_u),
    ]
    return [
        {"split": split, "readout": readout, "epsilon": pair[0], "n_u": pair[1]}
        for split in ("shuffled", held_out)
        for readout in READOUTS
        for pair in dict.fromkeys(pairs if readout != "none" else [chosen])
    ]


def judge_readout(
    cell: Mapping[str, Any], *, train: Data, test: Data, judgement: Judgement
) -> dict[str, Any]:
    """Return the errors of one cell, by its own split."""
    seed, readout = judgement.seed, cell["readout"]
    settings = {key: cell[key] for key in ("epsilon", "n_u") if readout != "none"}
    if readout == "shifted":
        train, test = shifted(train, seed), shifted(test, seed + 1)
    how = replace(judgement, split=cell["split"])
    changed = {"model": READOUTS[readout], **settings}
    return judge_cell(changed, train=train, test=test, judgement=how)


def shifted(data: Data, seed: int) -> Data:
    """Rotate P_o of each recording by a random time, a quarter to three quarters of its length.

    Samples in a random order would be no control for a P_o that leaks: their mean does not move.
    """
    rng = np.random.default_rng(seed)
    parts = np.split(data.channels["p_o_kpa"], np.cumsum(data.lengths)[:-1])
    rotated = [np.roll(part, int(rng.uniform(0.25, 0.75) * len(part))) for part in parts]
    return data._replace(channels={**data.channels, "p_o_kpa": np.concatenate(rotated)})
