"""Value of the reservoir's readout."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from fprc.artifacts import write_json
from fprc.evaluation.cells import checkpoint_key, log_progress, run_cells
from fprc.experiments.data import read_data, refuse_mixture
from fprc.experiments.readout import judge_readout, readout_cells
from fprc.experiments.settings import Judgement


def measure_readout(
    train: str,
    test: str,
    cells: str,
    *,
    judgement: Mapping[str, Any],
    epsilon: Sequence[float],
    n_u: Sequence[int],
    workers: int,
    checkpoint: str,
    version: str,
    progress: Callable[[int, int], None] = log_progress,
) -> None:
    """Cross-validate and test FPRC with each readout.

    Parameters
    ----------
    judgement : Mapping
        Arguments of ``fprc.experiments.settings.Judgement``, without ``split``, which each cell
        has.
    """
    data = read_data(train)
    refuse_mixture(data, read_data(test))
    models = judgement["models"]
    held_out = "recordings" if len(data.lengths) > 1 else "blocked"
    judged = run_cells(
        partial(_judge_from_files, train=train, test=test, judgement=judgement),
        readout_cells(models, epsilon, n_u, held_out),
        workers=workers,
        checkpoint=checkpoint,
        key=checkpoint_key([judgement, version], [train, test]),
        progress=progress,
    )
    described = {
        "source": data.attributes["source"],
        "seed": judgement["seed"],
        "target": data.attributes["target"],
        "unit": data.unit,
        "own": {key: models["fprc"][key] for key in ("epsilon", "n_u")},
    }
    write_json(cells, {**described, "cells": judged})
    Path(checkpoint).unlink()


def _judge_from_files(
    cell: Mapping[str, Any], *, train: str, test: str, judgement: Mapping[str, Any]
) -> dict[str, Any]:
    how = Judgement(**judgement, split=cell["split"])
    return judge_readout(cell, train=read_data(train), test=read_data(test), judgement=how)
