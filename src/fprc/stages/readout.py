"""Value of the reservoir's readout: FPRC with P_o, without it, and with substitutes for it."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from fprc.artifacts import write_json
from fprc.evaluation.cells import judged_cells
from fprc.experiments.data import judge_files, read_data, refuse_mixture
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
    **run: Any,
) -> None:
    """Cross-validate and test FPRC with each readout.

    Parameters
    ----------
    judgement : Mapping
        Arguments of ``fprc.experiments.settings.Judgement`` without ``split``, which differs
        between cells.
    **run
        ``workers``, ``checkpoint`` and ``version`` of ``judged_cells``.
    """
    data = read_data(train)
    refuse_mixture(data, read_data(test))
    models, how = judgement["models"], Judgement(**judgement, split="")
    held_out = "recordings" if len(data.lengths) > 1 else "blocked"
    described = {
        "source": data.attributes["source"],
        "seed": judgement["seed"],
        "target": data.attributes["target"],
        "unit": data.unit,
        "own": {key: models["fprc"][key] for key in ("epsilon", "n_u")},
    }
    with judged_cells(
        partial(judge_files, judge=judge_readout, train=train, test=test, judgement=how),
        readout_cells(models, epsilon, n_u, held_out),
        settings=judgement,
        files=[train, test],
        **run,
    ) as judged:
        write_json(cells, {**described, "cells": judged})
