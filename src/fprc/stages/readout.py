"""Value of the reservoir's readout: FPRC with P_o, without it, and with substitutes for it."""

from collections.abc import Mapping, Sequence
from typing import Any

from fprc.artifacts import write_json
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
) -> None:
    """Cross-validate and test FPRC with each readout.

    Parameters
    ----------
    judgement : Mapping
        Arguments of ``fprc.experiments.settings.Judgement`` without ``split``, which differs
        between cells.
    """
    data, tested = read_data(train), read_data(test)
    refuse_mixture(data, tested)
    models, how = judgement["models"], Judgement(**judgement, split="")
    held_out = "recordings" if len(data.lengths) > 1 else "blocked"
    described = {
        "source": data.attributes["source"],
        "seed": judgement["seed"],
        "target": data.attributes["target"],
        "unit": data.unit,
        "own": {key: models["fprc"][key] for key in ("epsilon", "n_u")},
    }
    judged = [
        {**cell, **judge_readout(cell, train=data, test=tested, judgement=how)}
        for cell in readout_cells(models, epsilon, n_u, held_out)
    ]
    write_json(cells, {**described, "cells": judged})
