"""Value of the reservoir's readout: FPRC with P_o, without it, and with substitutes for it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fprc.evaluation import evaluate
from fprc.experiments.data import Data
from fprc.experiments.settings import Judgement
from fprc.registry import build

#: Substitutes for P_o in FPRC: ``theta`` has the low-pass but no reservoir, ``shifted`` is P_o
#: of another time of the same recording, with its slow changes, ``none`` is Fuzzy-linear.
READOUTS = ("none", "p_o", "theta", "shifted")


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
    """Return the errors of one cell, by its own split if it has one."""
    seed, readout = judgement.seed, cell["readout"]
    judgement = replace(judgement, split=cell.get("split", judgement.split))
    if readout == "none":
        model = build("fuzzy_linear", judgement.models, seed)
    else:
        model = build("fprc", judgement.models, seed, epsilon=cell["epsilon"], n_u=cell["n_u"])
    logs = (
        (*inputs_with(readout, log, log_seed), log.lengths)
        for log, log_seed in ((train, seed), (test, seed + 1))
    )
    return evaluate(model, judgement.split_rows(train), *logs)


def inputs_with(readout: str, data: Data, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return theta_d and P_o or its substitute as columns, and P_exp."""
    theta, p_exp = data.channels["theta_deg"], data.channels["p_target_kpa"]
    if readout == "none":
        return theta[:, None], p_exp
    second = theta if readout == "theta" else data.channels["p_o_kpa"]
    if readout == "shifted":
        second = _shifted(second, data.lengths, seed)
    return np.column_stack([theta, second]), p_exp


def _shifted(values: np.ndarray, lengths: Sequence[int], seed: int) -> np.ndarray:
    """Rotate each recording by a random time, a quarter to three quarters of its length.

    Samples in a random order would be no control for a P_o that leaks: their mean does not move.
    """
    rng = np.random.default_rng(seed)
    parts = np.split(values, np.cumsum(lengths)[:-1])
    return np.concatenate(
        [np.roll(part, int(rng.uniform(0.25, 0.75) * len(part))) for part in parts]
    )
