"""Errors at the stop, where the actuator is straight and theta does not determine the pressure."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from fprc.evaluation.crossval import prepare
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import Judgement, Unit
from fprc.paper import MODELS
from fprc.registry import build, title_of
from fprc.signals import rms
from fprc.tables.models import means_of
from fprc.tables.text import format_mean

#: Below this angle the actuator lies against its stop, deg.
STOP_DEG = 0.5


def judge_stop(unit: Unit, *, judgement: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Train the paper's models on the sweep of one seed, on all samples and on those off the stop.

    Returns
    -------
    list of one dict
        ``seed``; ``at_stop``, the share of samples at the stop; and by model: ``share``, of the
        squared training error there; training errors ``at``, ``off`` the stop, ``test`` error, and
        that ``reversed``, kPa; and ``off`` and ``test`` again after training ``without`` the
        samples at the stop.
    """
    on_rig, seed = unit.rigs[0]
    logs, how = simulate(on_rig, seed), Judgement(**judgement, seed=seed)
    at_stop = logs["sweep"].channels["theta_deg"] < STOP_DEG
    found: dict[str, Any] = {"seed": seed, "at_stop": float(at_stop.mean())}
    for name in MODELS:
        samples = {log: logs[log].samples(name) for log in ("sweep", "complex")}
        prepared = prepare(build(name, how.models, how.seed), samples)
        whole, off = prepared.readout("sweep"), prepared.readout("sweep", ~at_stop)
        off_by = whole.predict(prepared.rows["sweep"]) - prepared.y["sweep"]
        squared = off_by**2
        found[name] = {
            "share": float(squared[at_stop].sum() / squared.sum()),
            "at": rms(off_by[at_stop]),
            "off": rms(off_by[~at_stop]),
            "test": prepared.error(whole, "complex"),
            "reversed": prepared.error(prepared.readout("complex"), "sweep"),
            "without_off": prepared.error(off, "sweep", ~at_stop),
            "without_test": prepared.error(off, "complex"),
        }
    return [found]


#: Columns of the page.
_COLUMNS = {
    "share": "Share of the squared training error at the stop [%]",
    "at": "Training RMSE at the stop [kPa]",
    "off": "Training RMSE off the stop [kPa]",
    "test": "Test RMSE [kPa]",
    "reversed": "Reversed test RMSE [kPa]",
    "without_off": "Trained without the stop: training RMSE [kPa]",
    "without_test": "Trained without the stop: test RMSE [kPa]",
}


def over_seeds(cells: Any) -> pd.DataFrame:
    """Return the numbers of ``judge_stop`` over seeds, tidy, with their 95 % intervals."""
    table = pd.DataFrame(
        {
            "rig": cell["family"],
            "model": name,
            "number": number,
            "value": value * (100.0 if number == "share" else 1.0),
        }
        for cell in cells
        for name in MODELS
        for number, value in cell[name].items()
    )
    return means_of(table, "rig", "model", "number").drop(columns=["min", "max"])


def page(table: pd.DataFrame) -> pd.DataFrame:
    """Return a row per rig and model."""
    texts = [format_mean(row, "mean") for row in table.to_dict("records")]
    numbers = table.assign(text=texts).set_index(["rig", "model", "number"])["text"]
    wide = numbers.unstack(sort=False)[list(_COLUMNS)]
    page = wide.rename(columns=_COLUMNS).reset_index(names=["Rig", "Model"])
    return page.assign(Model=page["Model"].map(title_of))
