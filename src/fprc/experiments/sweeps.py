"""Control-variable sweeps of Sec. III-E, and the weights of Fig. 9."""

import hashlib
import itertools
import json
import logging
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from fprc.artifacts import read_json, write_json
from fprc.evaluation import cross_validate, split_rows
from fprc.evaluation.sweeps import run_cells
from fprc.evaluation.weights import normalised_weights
from fprc.experiments.comparison import Data, able, build, read_data

log = logging.getLogger(__name__)


def cells_of(sweep: str, values: Mapping[str, Sequence[float]]) -> list[dict[str, Any]]:
    """Return what each cell of a sweep changes: a model and some of its settings."""
    if sweep == "epsilon":
        return [{"model": "fprc", "epsilon": value} for value in values["epsilon"]]
    if sweep == "n_c":
        return [
            {"model": model, "n_c": value}
            for model in ("fprc", "fuzzy_linear")
            for value in values["n_c"]
        ]
    pairs = itertools.product(values["n_u"], values["n_y"])
    return [{"model": "fprc", "n_u": n_u, "n_y": n_y} for n_u, n_y in pairs]


def sweep_settings(
    train: str,
    test: str,
    results: str,
    *,
    sweep: str,
    values: Mapping[str, Sequence[float]],
    models: Mapping[str, Any],
    folds: int,
    split: str,
    seed: int,
    workers: int,
    checkpoint: str,
    version: str,
    chunk: int = 0,
    chunks: int = 1,
) -> None:
    """Cross-validate and test every cell of one sweep, or of one chunk of it.

    ``version``, the fingerprint of the source, is part of the checkpoint's key:
    a checkpoint that other code, data or settings made is not used.

    Parameters
    ----------
    chunk, chunks : int
        Which chunk, from 0, of how many; ``join_sweep`` puts them together.
    """
    settings = {"models": models, "folds": folds, "split": split, "seed": seed}
    digest = hashlib.sha256(json.dumps([settings, version], sort_keys=True).encode())
    for path in (train, test):
        digest.update(Path(path).read_bytes())
    data = read_data(train)
    models_there = able(data, read_data(test))
    possible = [cell for cell in cells_of(sweep, values) if cell["model"] in models_there]
    cells = chunk_of(possible, chunk, chunks)
    judged = run_cells(
        partial(_judge_from_files, train=train, test=test, **settings),
        cells,
        workers=workers,
        checkpoint=checkpoint,
        key=digest.hexdigest(),
        progress=report_progress,
    )
    told = {"sweep": sweep, "source": data.attributes["source"], "seed": seed, "unit": data.unit}
    write_json(results, {**told, "cells": judged})
    Path(checkpoint).unlink()


def chunk_of(cells: Sequence[Any], chunk: int, chunks: int) -> list[Any]:
    """Return one of several runs of neighbours, which differ by one cell at most."""
    first, last = (len(cells) * edge // chunks for edge in (chunk, chunk + 1))
    return list(cells[first:last])


def join_sweep(chunks: Sequence[str], results: str) -> None:
    """Write the chunks of a sweep, in order, as if it had been one job."""
    parts = [read_json(path) for path in chunks]
    write_json(results, parts[0] | {"cells": [cell for part in parts for cell in part["cells"]]})


def judge_cell(
    cell: Mapping[str, Any],
    *,
    train: Data,
    test: Data,
    models: Mapping[str, Any],
    folds: int,
    split: str,
    seed: int,
) -> dict[str, Any]:
    """Return the errors of one cell."""
    name = cell["model"]
    X, y = train.pair(name)
    changed = {key: value for key, value in cell.items() if key != "model"}
    model = build(name, models, seed).set_params(**changed)
    judged = cross_validate(model, X, y, split_rows(len(y), folds, split, seed))
    return {
        "train_rmse_kpa": judged.train_rmse,
        "validation_rmse_kpa": judged.validation_rmse,
        "test_rmse_kpa": judged.test_rmse(*test.pair(name)),
    }


def _judge_from_files(cell: Mapping[str, Any], *, train: str, test: str, **settings: Any) -> dict:
    # in a worker: small arguments, each process reads for itself
    return judge_cell(cell, train=read_data(train), test=read_data(test), **settings)


def weigh(
    train: str,
    weights: str,
    *,
    models: Mapping[str, Any],
    folds: int,
    split: str,
    seed: int,
) -> None:
    """Write the normalised weights of the FPRC, rule by rule."""
    data = read_data(train)
    shares = weight_shares(data, models, folds, split, seed)
    write_json(weights, {"source": data.attributes["source"], "seed": seed, **shares})
    log.info("mean shares: P_o {p_o:.3f}, theta_d {theta_d:.3f}".format(**shares["mean_share"]))


def weight_shares(
    train: Data, models: Mapping[str, Any], folds: int, split: str, seed: int
) -> dict[str, Any]:
    """Return the share of each feature in the weights, by rule and in the mean (Fig. 9)."""
    X, y = train.pair("fprc")
    model = build("fprc", models, seed)
    shares = normalised_weights(model, X, y, split_rows(len(y), folds, split, seed))
    edges = {"bias": (0, 1), "theta_d": (1, 1 + model.n_y), "p_o": (1 + model.n_y, None)}
    parts = {name: shares[:, slice(*edge)] for name, edge in edges.items()}
    return {
        "mean_share": {name: float(part.sum(axis=1).mean()) for name, part in parts.items()},
        "shares": {name: part.tolist() for name, part in parts.items()},
    }


def report_progress(done: int, total: int) -> None:
    """Draw a bar of finished cells."""
    width = 30
    bar = "#" * (width * done // total)
    log.info("[%-*s] %d of %d cells", width, bar, done, total)
