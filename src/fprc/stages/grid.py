"""Grids of control variables, Sec. III-E, and the weights of Fig. 9."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

from fprc.artifacts import write_json
from fprc.experiments.data import read_data
from fprc.experiments.grids import evaluate_grids, weight_shares
from fprc.experiments.settings import CrossValidation

log = logging.getLogger(__name__)


def judge(
    train: str,
    test: str,
    cells: str,
    *,
    values: Mapping[str, Sequence[float]],
    validation: Mapping[str, Any],
) -> None:
    """Cross-validate and test every cell of every grid, on logs that have no further seeds.

    Parameters
    ----------
    validation : Mapping
        Arguments of ``fprc.experiments.settings.CrossValidation``.
    """
    data = {"sweep": read_data(train), "complex": read_data(test)}
    described = {
        "source": data["sweep"].attributes["source"],
        "seed": validation["seed"],
        "unit": data["sweep"].unit,
    }
    write_json(cells, described | evaluate_grids(data, values, CrossValidation(**validation)))


def weigh(train: str, weights: str, *, validation: Mapping[str, Any]) -> None:
    """Write the normalised weights of the FPRC, rule by rule."""
    data = read_data(train)
    shares = weight_shares(data, CrossValidation(**validation))
    described = {"source": data.attributes["source"], "seed": validation["seed"]}
    write_json(weights, {**described, **shares})
    log.info("mean shares: P_o {p_o:.3f}, theta_d {theta_d:.3f}".format(**shares["mean_share"]))
