"""What the reservoir's readout is worth: FPRC with P_o, without, and with stand-ins for it."""

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from fprc.artifacts import write_json
from fprc.evaluation import cross_validate, split_rows
from fprc.evaluation.sweeps import run_cells
from fprc.experiments.comparison import Data, build, read_data, refuse_mixture
from fprc.experiments.sweeps import report_progress

#: What takes the place of P_o in FPRC. ``theta`` has the low-pass but no reservoir; ``shuffled``
#: has P_o's values at random times; ``none`` is Fuzzy-linear.
READOUTS = ("none", "p_o", "theta", "shuffled")

SPLITS = ("shuffled", "blocked")


def readout_cells(
    models: Mapping[str, Any], epsilon: Sequence[float], n_u: Sequence[int]
) -> list[dict[str, Any]]:
    """Return the cells: each readout at the models' settings, and over epsilon and n_u."""
    own = models["fprc"]["epsilon"], models["fprc"]["n_u"]
    pairs = [own, *((value, own[1]) for value in epsilon), *((own[0], value) for value in n_u)]
    return [
        {"split": split, "readout": readout, "epsilon": pair[0], "n_u": pair[1]}
        for split in SPLITS
        for readout in READOUTS
        for pair in dict.fromkeys(pairs if readout != "none" else [own])
    ]


def measure_readout(
    train: str,
    test: str,
    cells: str,
    *,
    models: Mapping[str, Any],
    epsilon: Sequence[float],
    n_u: Sequence[int],
    folds: int,
    seed: int,
    workers: int,
    checkpoint: str,
    version: str,
    progress: Callable[[int, int], None] = report_progress,
) -> None:
    """Cross-validate and test FPRC with each readout."""
    data = read_data(train)
    refuse_mixture(data, read_data(test))
    settings = {"models": models, "folds": folds, "seed": seed}
    digest = hashlib.sha256(json.dumps([settings, version], sort_keys=True).encode())
    for path in (train, test):
        digest.update(Path(path).read_bytes())
    judged = run_cells(
        partial(_judge_from_files, train=train, test=test, **settings),
        readout_cells(models, epsilon, n_u),
        workers=workers,
        checkpoint=checkpoint,
        key=digest.hexdigest(),
        progress=progress,
    )
    source, target = (data.attributes[key] for key in ("source", "target"))
    own = {key: models["fprc"][key] for key in ("epsilon", "n_u")}
    told = {"source": source, "seed": seed, "target": target, "unit": data.unit, "own": own}
    write_json(cells, {**told, "cells": judged})
    Path(checkpoint).unlink()


def _judge_from_files(cell: Mapping[str, Any], *, train: str, test: str, **settings: Any) -> dict:
    return judge_readout(cell, train=read_data(train), test=read_data(test), **settings)


def judge_readout(
    cell: Mapping[str, Any],
    *,
    train: Data,
    test: Data,
    models: Mapping[str, Any],
    folds: int,
    seed: int,
) -> dict[str, Any]:
    """Return the errors of one cell."""
    name = "fuzzy_linear" if cell["readout"] == "none" else "fprc"
    model = build(name, models, seed)
    if name == "fprc":
        model.set_params(epsilon=cell["epsilon"], n_u=cell["n_u"])
    X, y = inputs_with(cell["readout"], train, seed)
    judged = cross_validate(model, X, y, split_rows(len(y), folds, cell["split"], seed))
    return {
        "train_rmse_kpa": judged.train_rmse,
        "validation_rmse_kpa": judged.validation_rmse,
        "test_rmse_kpa": judged.test_rmse(*inputs_with(cell["readout"], test, seed + 1)),
    }


def inputs_with(readout: str, data: Data, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return theta_d and what stands for P_o as columns, and P_exp."""
    theta, p_exp = data.channels["theta_deg"], data.channels["p_exp_kpa"]
    if readout == "none":
        return theta[:, None], p_exp
    second = theta if readout == "theta" else data.channels["p_o_kpa"]
    if readout == "shuffled":
        second = np.random.default_rng(seed).permutation(second)
    return np.column_stack([theta, second]), p_exp
