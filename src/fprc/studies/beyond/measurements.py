"""Read the measurements of a family of the target ``beyond``; a family is one rig or a set of rigs.

A family has ``name``, ``fitted`` (the terms that its rigs were fitted to), ``cells`` (one per rig
and seed, with the errors of each model), and may have ``capacity``.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from fprc.paper import REFERENCES
from fprc.signals import rms

#: Measures of every model, as readers see them, with their units; errors are RMSE.
MEASURES = {
    "train": "training [kPa]",
    "forward": "forward test [kPa]",
    "reversed": "reversed test [kPa]",
    "open_loop": "open loop [deg]",
    "closed_loop": "closed loop [deg]",
}

#: Loops of a tracking run, open and closed.
LOOPS = ("open_loop", "closed_loop")

#: Sets of states whose capacity is measured, as readers see them.
SETS = {
    "p_o": "P_o",
    "p_o_taps": "taps of P_o",
    "p_o_virtual": "virtual nodes of P_o",
    "theta_lowpass_taps": "taps of low-passed theta_d",
    "bank": "bank of low-passes",
    "esn": "ESN",
    "esn_noisy": "ESN, noise of P_o",
}

#: Names of families for readers, where these are not those of the settings.
_TITLES = {"bouc_wen": "Bouc-Wen", "near_print": "near print"}


def family_of(report: Mapping[str, Any]) -> dict[str, Any]:
    """Return the one family of a report of ``fprc.studies.stages.judge`` with what was measured."""
    ((name, described),) = report["families"].items()
    return {"name": name, **described, "cells": report["cells"]}


def family_title(name: str) -> str:
    """Return a family's name for readers."""
    return _TITLES.get(name, name.replace("_", "-"))


def measured(families: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return every number of the models in families, tidy.

    Returns
    -------
    DataFrame
        ``world``, ``unit``, ``seed``, ``model``, ``measure`` and ``value``, see
        ``contest.judge_rig``. What was not measured has no row, and neither has a model that could
        not be judged.
    """
    rows = [
        (family["name"], cell["unit"], cell["seed"], model, measure, value)
        for family in families
        for cell in family["cells"]
        for model, report in cell.get("models", {}).items()
        if "failed" not in report
        for measure, value in report.items()
    ]
    columns = ["world", "unit", "seed", "model", "measure", "value"]
    return pd.DataFrame(rows, columns=columns).astype({"value": float})


def over_references(errors_deg: Mapping[str, float]) -> float:
    """Return the root mean square of the errors over the references of Table IV."""
    return rms(np.array([errors_deg[name] for name in REFERENCES]))


def capacities(families: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return the capacities of every set of states in families, tidy.

    Returns
    -------
    DataFrame
        ``world``, ``unit``, ``seed``, ``set``, ``states``, ``quantity``, ``value``. Quantities are
        ``memory``, ``total``, ``degree N`` for each degree, and ``nonlinear``, which sums the
        degrees from 2 on.
    """
    rows = []
    found = [(family["name"], entry) for family in families for entry in family.get("capacity", ())]
    for family, entry in found:
        for name, of_set in entry["sets"].items():
            degrees = of_set["by_degree"]
            numbers = {"memory": degrees["1"], "total": sum(degrees.values())}
            numbers |= {f"degree {n}": value for n, value in degrees.items()}
            numbers["nonlinear"] = sum(value for n, value in degrees.items() if int(n) > 1)
            of_states = (family, entry["unit"], entry["seed"], name, of_set["states"])
            rows += [(*of_states, *number) for number in numbers.items()]
    columns = ["world", "unit", "seed", "set", "states", "quantity", "value"]
    return pd.DataFrame(rows, columns=columns).astype({"value": float})
