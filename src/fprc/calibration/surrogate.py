"""Errors of the three models by a cheap surrogate of the full comparison."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fprc.evaluation import rmse
from fprc.paper import DIRECTIONS, MODELS
from fprc.registry import build, entries

Channels = Mapping[str, np.ndarray]


def surrogate_errors(
    logs: Mapping[str, Channels],
    models: Mapping[str, Any],
    *,
    stride: int,
    esn_nodes: int,
    seed: int,
) -> dict[str, float]:
    """Return training and test RMSE of each model in both directions, kPa.

    Instead of five folds, one readout is fitted to every ``stride``-th row, and
    the ESN has ``esn_nodes`` nodes. The features have memory and so are computed
    over the whole log.

    Parameters
    ----------
    logs : Mapping
        Channels of the logs "sweep" and "complex"; ``p_target_kpa`` is the target.

    Returns
    -------
    dict
        By "trained on/model/phase", with phase train or test.
    """
    errors = {}
    for name in MODELS:
        model = build(name, models, seed)
        if name == "esn":
            model.set_params(r=esn_nodes)
        X = {
            log: np.column_stack([logs[log][key] for key in entries()[name].inputs]) for log in logs
        }
        features = model.make_features().fit(X["sweep"])
        rows = {log: features.transform(X[log])[::stride] for log in logs}
        y = {log: logs[log]["p_target_kpa"][::stride] for log in logs}
        for train, test in DIRECTIONS:
            readout = model.make_readout().fit(rows[train], y[train])
            for phase, log in (("train", train), ("test", test)):
                errors[f"{train}/{name}/{phase}"] = rmse(y[log], readout.predict(rows[log]))
    return errors
