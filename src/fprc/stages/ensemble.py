"""Rigs that were not fitted: which claims hold on them, and what decides it."""

import hashlib
import json
import logging
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from pydantic import ValidationError

from fprc.artifacts import read_json, write_json
from fprc.calibration import Free, decode, encode, properties
from fprc.claims import Results, judge_claims
from fprc.claims.ensemble import JUDGED_BY_RIG, shares_of
from fprc.config.rig import Rig
from fprc.errors import EvaluationError, FprcError, SimulationError
from fprc.evaluation.sweeps import run_cells
from fprc.stages.calibrate import free_parameters, judge_cheaply
from fprc.stages.replicate import compare_models, measure_control, simulate
from fprc.stages.sweep import report_progress
from fprc.stages.track import Track

log = logging.getLogger(__name__)


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
    chosen = {key: ensemble[key] for key in ("seed", "angle_deg", "p_o_swing_kpa")}
    key = json.dumps([chosen, paths, ranges, settings, version], sort_keys=True)
    judged = run_cells(
        partial(judge_rig, ensemble=chosen, free=free_parameters(paths, ranges), **settings),
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
        compared = compare_models(data, models, folds, split, seed)
        bench = Track(tracking, control, drawn, seed)
        measured = measure_control(data, bench, models, folds, split)
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
    """Draw rigs, uniform over the ranges, until one bends and squeezes plausibly.

    Returns
    -------
    dict, int
        The rig, and how many draws it took.
    """
    rng = np.random.default_rng(seed)
    sweep = {"sweep": signals["sweep"]}
    draws = 0
    while True:
        draws += 1
        drawn = decode(rng.uniform(size=len(free)), rig, free)
        try:
            Rig.model_validate(drawn)
            logs = simulate(sweep, control, drawn, target, seed)
            found = properties({"sweep": logs["sweep"].channels})
        except (ValidationError, SimulationError, EvaluationError):
            continue
        if all(
            ensemble[name][0] <= found[name] <= ensemble[name][1]
            for name in ("angle_deg", "p_o_swing_kpa")
        ):
            return drawn, draws


def summarise_rigs(published: str, chunks: Sequence[str], summary: str) -> None:
    """Judge the claims rig by rig; write shares, intervals and correlations."""
    printed = yaml.safe_load(Path(published).read_text(encoding="utf-8"))
    rigs = [rig for path in chunks for rig in read_json(path)["rigs"]]
    good = [rig for rig in rigs if "failed" not in rig]
    if not good:
        raise FprcError(
            f"none of the {len(rigs)} rigs of the ensemble could be judged; the first: "
            f"{rigs[0]['failed']}"
        )
    claims = [claim for claim in printed["claims"] if claim["id"] in JUDGED_BY_RIG]
    verdicts = [
        {
            row["id"]: row["verdict"]
            for row in judge_claims(
                claims, Results([rig["compared"]], [], [rig["measured"]], {}, {}), printed
            )
        }
        for rig in good
    ]
    parameters = [rig["parameters"] for rig in good]
    write_json(
        summary,
        {
            "source": "sim",
            "seed": min(rig["seed"] for rig in rigs),
            "parameters": list(parameters[0]),
            "rigs": len(rigs),
            "failed": len(rigs) - len(good),
            "draws": sum(rig["draws"] for rig in rigs),
            "claims": shares_of(claims, verdicts, parameters),
        },
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
    except (ValidationError, SimulationError) as error:
        return {"errors": None, "impossible": str(error).splitlines()[0]}
    return {"errors": {key: float(np.mean([e[key] for e in errors])) for key in errors[0]}}
