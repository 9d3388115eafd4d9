"""An ensemble of random rigs, drawn instead of fitted, on which the claims are tested."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pydantic import ValidationError

from fprc.config.rig import Rig
from fprc.errors import EvaluationError, FprcError
from fprc.experiments.comparison import compare_models
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import Judgement, RigSettings
from fprc.experiments.tracking import Track, measure_control
from fprc.registry import controllers
from fprc.studies.calibration.objective import properties
from fprc.studies.calibration.space import Free, decode, encode, free_parameters
from fprc.studies.calibration.surrogate import judge_by_surrogate

_MOST_DRAWS = 2000

#: Second seed of the random numbers that draw the rigs' parameters.
_PARAMETERS = 20241


def judge_rig(
    cell: Mapping[str, int],
    *,
    ensemble: Mapping[str, Any],
    free: Sequence[Free],
    on_rig: RigSettings,
    tracking: Mapping[str, Any],
    judgement: Mapping[str, Any],
) -> dict[str, Any]:
    """Draw the rig with the number ``cell["rig"]`` and judge it; see ``judge_drawn``.

    Parameters
    ----------
    judgement : Mapping
        Arguments of ``Judgement`` without the seed, which is the rig's own.
    """
    seed = ensemble["seed"] + cell["rig"]
    drawn, _, draws = draw_rig(seed, ensemble, free, on_rig)
    return {"draws": draws} | judge_drawn(drawn, seed, free, tracking, judgement)


def judge_drawn(
    drawn: RigSettings,
    seed: int,
    free: Sequence[Free],
    tracking: Mapping[str, Any],
    judgement: Mapping[str, Any],
) -> dict[str, Any]:
    """Return a rig's ``seed``, ``parameters``, ``compared`` errors and ``measured`` control.

    Where an error ended the judgement, that is ``failed`` instead of the last two.
    """
    judged = {
        "seed": seed,
        "parameters": dict(
            zip((p.path for p in free), encode(drawn.rig, free).tolist(), strict=True)
        ),
    }
    how = Judgement(**judgement, seed=seed)
    bench = Track(tracking, drawn.control, drawn.rig, seed)
    try:
        data = simulate(drawn, seed)
        compared, models = compare_models(data, how)
        measured = measure_control(data["sweep"], bench, models, controllers(how.models))
    except FprcError as error:
        return judged | {"failed": str(error)}
    return judged | {"compared": compared, "measured": measured}


def draw_rig(
    seed: int,
    ensemble: Mapping[str, Any],
    free: Sequence[Free],
    on_rig: RigSettings,
) -> tuple[RigSettings, np.ndarray, int]:
    """Draw rigs until one bends and squeezes plausibly.

    Free parameters are uniform over their ranges, or log-uniform where a range
    spans a decade; all others are as in ``on_rig``.

    Returns
    -------
    RigSettings, ndarray, int
        ``on_rig`` with the drawn rig, its parameters as shares of their ranges, and the number of
        draws.

    Raises
    ------
    EvaluationError
        None of 2000 rigs is plausible.
    """
    # a second seed: default_rng(seed) alone also draws the sensors' errors
    rng = np.random.default_rng([seed, _PARAMETERS])
    sweep = {"sweep": on_rig.signals["sweep"]}
    for draws in range(1, _MOST_DRAWS + 1):
        shares = rng.uniform(size=len(free))
        rig = decode(shares, on_rig.rig, free)
        try:
            Rig.model_validate(rig)
            logs = simulate(replace(on_rig, rig=rig, signals=sweep), seed)
            measured = properties({"sweep": logs["sweep"].channels})
        except (ValidationError, FprcError):
            continue
        if is_plausible(measured, ensemble):
            return replace(on_rig, rig=rig), shares, draws
    raise EvaluationError(
        f"none of {_MOST_DRAWS} rigs bends by {ensemble['angle_deg']} deg and swings P_o by "
        f"{ensemble['p_o_swing_kpa']} kPa; widen ensemble.angle_deg or ensemble.p_o_swing_kpa"
    )


def is_plausible(properties: Mapping[str, float], ensemble: Mapping[str, Any]) -> bool:
    """Return whether a rig's largest angle and swing of P_o are within the ensemble's limits."""
    return all(
        ensemble[name][0] <= properties[name] <= ensemble[name][1]
        for name in ("angle_deg", "p_o_swing_kpa")
    )


def judge_moved(
    cell: Mapping[str, Any],
    *,
    seeds: Sequence[int],
    surrogate: Mapping[str, int],
    on_rig: RigSettings,
    models: Mapping[str, Any],
) -> dict[str, Any]:
    """Return the surrogate's errors, means over seeds, on a rig with one parameter changed.

    ``cell`` holds its ``path``, None for no change, and its value as a ``share`` of its range.
    """
    moved = on_rig.rig
    if cell["path"] is not None:
        moved = decode(np.array([cell["share"]]), moved, free_parameters([cell["path"]]))
    try:
        Rig.model_validate(moved)
        settings = replace(on_rig, rig=moved)
        errors = [
            judge_by_surrogate(settings, seed, models, surrogate, {}, {})["errors"]
            for seed in seeds
        ]
    except (ValidationError, FprcError) as error:
        return {"errors": None, "impossible": " ".join(str(error).split())}
    return {"errors": {key: float(np.mean([e[key] for e in errors])) for key in errors[0]}}
