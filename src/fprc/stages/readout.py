"""Value of the reservoir's readout: FPRC with P_o, without it, and with substitutes for it."""

from collections.abc import Mapping
from typing import Any

from fprc.artifacts import write_json
from fprc.experiments.data import read_data, refuse_mixture
from fprc.experiments.readout import judge_readouts
from fprc.experiments.settings import Judgement


def measure_readout(
    train: str,
    test: str,
    cells: str,
    *,
    judgement: Mapping[str, Any],
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
    how = Judgement(**judgement, split="")
    held_out = "recordings" if len(data.lengths) > 1 else "blocked"
    described = {
        "source": data.attributes["source"],
        "seed": judgement["seed"],
        "target": data.attributes["target"],
        "unit": data.unit,
        "own": {key: how.models["fprc"][key] for key in ("epsilon", "n_u")},
    }
    write_json(cells, {**described, "cells": judge_readouts(data, tested, how, held_out)})
