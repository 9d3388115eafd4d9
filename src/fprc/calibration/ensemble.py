"""Rigs that were not fitted: which claims hold on them, and what decides it."""

import hashlib
import json
import logging
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from fprc.artifacts import write_json
from fprc.calibration import Free, decode, encode, properties
from fprc.calibration.fit import free_parameters, judge_cheaply
from fprc.config.rig import Rig
from fprc.errors import EvaluationError, FprcError
from fprc.evaluation.sweeps import run_cells
from fprc.experiments.sweeps import report_progress
from fprc.experiments.tracking import Track
from fprc.stages.replicate import compare_models, measure_control, simulate

log = logging.getLogger(__name__)

_MOST_DRAWS = 2000


def judge_rigs(
    rigs: str,
    *,
    numbers: Sequence[int],
    ensemble: Mapping[str, Any],
    paths: Sequence[str],
    ranges: Mapping[str, Sequence[float]],
    checkpoint: str,
    version: str,
    **settings: Any,
) -> None:
    """Take some rigs of the ensemble through Tables II to IV.

    Parameters
    ----------
    numbers : sequence of int
        Which rigs; a rig is the same in whatever chunk it is.
    paths, ranges
        The free parameters, as ``free_parameters`` takes them.
    **settings
        ``rig``, ``signals``, ``control``, ``tracking``, ``target``, ``models``, ``folds``,
        ``split``.
    """
    key = json.dumps([ensemble, paths, ranges, settings, version], sort_keys=True)
    judged = run_cells(
        partial(judge_rig, ensemble=ensemble, free=free_parameters(paths, ranges), **settings),
        [{"rig": number} for number in numbers],
        workers=1,
        checkpoint=checkpoint,
        key=hashlib.sha256(key.encode()).hexdigest(),
        progress=report_progress,
    )
    write_json(rigs, {"source": "sim", "rigs": judged})
    Path(checkpoint).unlink()


def judge_rig(
    cell: Mapping[str, int],
    *,
    ensemble: Mapping[str, Any],
    free: Sequence[Free],
    rig: Mapping[str, Any],
    signals: Mapping[str, Any],
    control: Mapping[str, Any],
    tracking: Mapping[str, Any],
    target: str,
    models: Mapping[str, Any],
    folds: int,
    split: str,
) -> dict[str, Any]:
    """Return parameters, errors and measures of one rig, or why it could not be judged."""
    seed = ensemble["seed"] + cell["rig"]
    drawn, draws = draw_rig(seed, ensemble, free, rig, signals, control, target)
    shares = encode(drawn, free)
    described = {
        "seed": seed,
        "draws": draws,
        "parameters": dict(zip((p.path for p in free), shares.tolist(), strict=True)),
    }
    try:
        data = simulate(signals, control, drawn, target, seed)
        compared, fprc = compare_models(data, models, folds, split, seed)
        measured = measure_control(data["sweep"], Track(tracking, control, drawn, seed), fprc)
    except FprcError as error:
        return described | {"failed": str(error)}
    return described | {"compared": compared, "measured": measured}


def draw_rig(
    seed: int,
    ensemble: Mapping[str, Any],
    free: Sequence[Free],
    rig: Mapping[str, Any],
    signals: Mapping[str, Any],
    control: Mapping[str, Any],
    target: str,
) -> tuple[dict[str, Any], int]:
    """Draw rigs until one bends and squeezes plausibly.

    Free parameters are uniform over their ranges, by the logarithm where a
    range spans a decade; all else is as in ``rig``.

    Returns
    -------
    dict, int
        The rig, and how many draws it took.
    """
    rng = np.random.default_rng(seed)
    sweep = {"sweep": signals["sweep"]}
    for draws in range(1, _MOST_DRAWS + 1):
        drawn = decode(rng.uniform(size=len(free)), rig, free)
        try:
            Rig.model_validate(drawn)
            logs = simulate(sweep, control, drawn, target, seed)
            found = properties({"sweep": logs["sweep"].channels})
        except (ValidationError, FprcError):
            continue
        if all(
            ensemble[name][0] <= found[name] <= ensemble[name][1]
            for name in ("angle_deg", "p_o_swing_kpa")
        ):
            return drawn, draws
    raise EvaluationError(
        f"none of {_MOST_DRAWS} rigs bends by {ensemble['angle_deg']} deg and swings P_o by "
        f"{ensemble['p_o_swing_kpa']} kPa; widen ensemble.angle_deg or ensemble.p_o_swing_kpa"
    )


def measure_sensitivity(
    effects: str,
    *,
    paths: Sequence[str],
    steps: int,
    seeds: Sequence[int],
    standin: Mapping[str, int],
    workers: int,
    checkpoint: str,
    version: str,
    **settings: Any,
) -> None:
    """Move one parameter at a time over its range, and judge the rig by the stand-in.

    Parameters
    ----------
    **settings
        ``rig``, ``signals``, ``control``, ``target``, ``models``.
    """
    shares = np.linspace(0.0, 1.0, steps).tolist()
    cells = [{"path": path, "share": share} for path in paths for share in shares]
    key = json.dumps([seeds, standin, settings, version], sort_keys=True)
    judged = run_cells(
        partial(_judge_moved, seeds=seeds, standin=standin, **settings),
        [{"path": None, "share": None}, *cells],
        workers=workers,
        checkpoint=checkpoint,
        key=hashlib.sha256(key.encode()).hexdigest(),
        progress=report_progress,
    )
    write_json(effects, {"source": "sim", "seeds": list(seeds), "cells": judged})
    Path(checkpoint).unlink()


def _judge_moved(
    cell: Mapping[str, Any],
    *,
    seeds: Sequence[int],
    standin: Mapping[str, int],
    rig: Mapping[str, Any],
    signals: Mapping[str, Any],
    control: Mapping[str, Any],
    target: str,
    models: Mapping[str, Any],
) -> dict[str, Any]:
    experiments = {"signals": signals, "control": control, "target": target}
    moved = rig
    if cell["path"] is not None:
        moved = decode(np.array([cell["share"]]), rig, free_parameters([cell["path"]]))
    try:
        Rig.model_validate(moved)
        errors = [judge_cheaply(moved, seed, experiments, models, standin)[0] for seed in seeds]
    except (ValidationError, FprcError) as error:
        return {"errors": None, "impossible": " ".join(str(error).split())}
    return {"errors": {key: float(np.mean([e[key] for e in errors])) for key in errors[0]}}
