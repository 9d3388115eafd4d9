"""Tracking errors on one rig whose P_o or whose actuator has changed since the training."""

from collections.abc import Mapping
from copy import deepcopy
from typing import Any

import numpy as np

from fprc.config.settings import Tracking
from fprc.experiments.data import simulate
from fprc.experiments.tracking import Track, columns_for, tracking_errors
from fprc.models import SequenceModel
from fprc.paper import REFERENCES
from fprc.registry import build
from fprc.studies.family import Unit

#: Constant offsets of P_o since the training, kPa.
OFFSETS_KPA = (-5.0, -2.0, -1.0, 1.0, 2.0, 5.0)
#: A slow leak, kPa a minute; and a step of the temperature, K, from the middle of a run on.
LEAK_KPA_PER_MIN, STEP_K = 4.0, 5.0
_ATMOSPHERE_K, _ATMOSPHERE_KPA = 293.0, 101.3
#: Factors of the actuator's parameters: another load, and a worn actuator.
CHANGED_RIGS = {
    "stiffer": {"stiffness_kpa_per_deg": 1.1, "cubic_stiffness_kpa_per_deg3": 1.1},
    "worn": {"friction_kpa": 0.8, "friction_per_kpa": 0.8},
}
#: Conditions, and those that make no difference to a model without P_o.
OF_P_O = (*(f"{offset:+g} kPa" for offset in OFFSETS_KPA), "leak", "warmer")
CONDITIONS = ("none", *OF_P_O, *CHANGED_RIGS)
#: Models, of which only the first reads P_o.
MODELS = ("fprc", "fprc_lowpass", "fuzzy_linear")
#: What multiplies the gains of the feedback.
LOOPS = {"open": 0.0, "closed": 1.0}


def disturbed(p_o_kpa: np.ndarray, condition: str, rate_hz: float) -> np.ndarray:
    """Return P_o under a condition, kPa gauge."""
    if condition.endswith(" kPa"):
        return p_o_kpa + float(condition.removesuffix(" kPa"))
    time_s = np.arange(len(p_o_kpa)) / rate_hz
    if condition == "leak":
        return p_o_kpa - LEAK_KPA_PER_MIN / 60.0 * time_s
    if condition == "warmer":
        warm = time_s >= 0.5 * time_s[-1]
        return p_o_kpa + warm * (p_o_kpa + _ATMOSPHERE_KPA) * STEP_K / _ATMOSPHERE_K
    return p_o_kpa


def changed_rig(rig: Mapping[str, Any], condition: str) -> dict[str, Any]:
    """Return the rig under a condition."""
    changed = deepcopy(dict(rig))
    for name, factor in CHANGED_RIGS.get(condition, {}).items():
        changed["bending"][name] *= factor
    return changed


def judge_online(
    unit: Unit, *, tracking: Mapping[str, Any], models: Mapping[str, Any]
) -> dict[str, Any]:
    """Return ``rows`` of the rig of a unit, see ``followed``."""
    on_rig, seed = unit.on_rig, unit.seed
    sweep = simulate(on_rig.changed(signals={"sweep": on_rig.signals["sweep"]}), seed)["sweep"]
    fitted = {}
    for name in MODELS:
        X, y, _ = sweep.samples(name)
        fitted[name] = build(name, models, seed).fit(X, y).remember(X)
    rows: list[dict[str, Any]] = []
    for condition in CONDITIONS:
        rig = changed_rig(on_rig.rig, condition)
        rows += followed(Track(Tracking(**tracking), on_rig.control, rig, seed), condition, fitted)
    return {"rows": rows}


def followed(
    bench: Track, condition: str, models: Mapping[str, SequenceModel]
) -> list[dict[str, Any]]:
    """Return the RMSE of each run under a condition, deg; under one of P_o FPRC's alone."""
    inputs = {reference: bench.inputs(reference) for reference in REFERENCES}
    for X in inputs.values():
        X[:, 1] = disturbed(X[:, 1], condition, bench.control.sample_rate_hz)
    chosen = [name for name in models if name == "fprc" or condition not in OF_P_O]
    trials = [(name, learns, LOOPS) for name in chosen for learns in (False, True)]
    trials += [] if condition in OF_P_O else [("pd", False, {"closed": 1.0})]
    rows = []
    for name, learns, loops in trials:
        learning = bench.control.feedforward.changed(adapt=learns)
        learner = bench._replace(control=bench.control.changed(feedforward=learning))
        model, given = models.get(name), inputs
        if model:
            given = {reference: columns_for(name, X) for reference, X in inputs.items()}
        rows += [
            {"model": name, "condition": condition, "learns": learns, "loop": loop,
             "reference": reference, "rmse_deg": error}
            for loop, errors in tracking_errors(learner, model, loops, given).items()
            for reference, error in errors.items()
        ]  # fmt: skip
    return rows
