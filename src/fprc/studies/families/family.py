"""Families of simulated rigs: one rig with many seeds, rigs near print, rigs drawn at random.

A unit of a family is a seed, if it has one rig, else a rig.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from pydantic import ValidationError

from fprc.artifacts import read_json
from fprc.config.rig import Rig
from fprc.config.tracking import Tracking
from fprc.errors import EvaluationError, FprcError, in_one_line
from fprc.experiments.comparison import compare_models
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import Judgement, RigSettings, Unit
from fprc.experiments.tracking import Track, measure_control
from fprc.registry import controllers
from fprc.studies.calibration.objective import properties
from fprc.studies.calibration.space import Free, decode, free_parameters

_MOST_DRAWS = 2000

#: Seed of the first drawn rig, and ranges outside which a drawn rig is rejected.
FIRST_DRAWN = 1000
ACCEPTED = {"angle_deg": (50.0, 70.0), "p_o_swing_kpa": (30.0, 100.0)}

#: Second seed of the random numbers that draw the rigs' parameters.
_PARAMETERS = 20241


def unit_of(number: int, family: Mapping[str, Any], near_print: str = "") -> Unit:
    """Return a unit of a family, with its rig and seeds.

    Parameters
    ----------
    family : Mapping
        ``rigs`` (one, near_print or drawn), ``first_seed``, ``seeds_per_rig``, ``on_rig``
        (arguments of ``RigSettings``); and, for drawn rigs, ``free`` (arguments of
        ``free_parameters``).
    near_print : str
        File of the rigs near print, JSON.

    Raises
    ------
    FprcError
        The file has fewer rigs.
    """
    on_rig = RigSettings(**family["on_rig"])
    if family["rigs"] == "near_print":
        known = read_json(near_print)["rigs"]
        if number >= len(known):
            raise FprcError(
                f"{near_print}: has {len(known)} rigs, and rig {number} is needed; reduce "
                "beyond.units"
            )
        on_rig = on_rig.changed(rig=Rig.model_validate(known[number]).model_dump(mode="json"))
    elif family["rigs"] == "drawn":
        on_rig = draw_rig(FIRST_DRAWN + number, free_parameters(**family["free"]), on_rig)
    first = family["first_seed"] + number * family["seeds_per_rig"]
    seeds = range(first, first + family["seeds_per_rig"])
    return Unit(number, family, [(on_rig, seed) for seed in seeds])


def judge_tables(
    unit: Unit, *, tracking: Mapping[str, Any], judgement: Mapping[str, Any]
) -> list[dict[str, Any]]:
    """Judge the rig of a unit with the full models, on the first of its seeds.

    Parameters
    ----------
    judgement : Mapping
        Arguments of ``Judgement`` without the seed.

    Returns
    -------
    list of one dict
        ``seed``, and ``compared`` (Tables II and III) and ``measured`` (Table IV); or
        ``failed`` instead of these two, where an error ended the judgement.
    """
    on_rig, seed = unit.rigs[0]
    how = Judgement(**judgement, seed=seed)
    bench = Track(Tracking(**tracking), on_rig.control, on_rig.rig, seed)
    try:
        data = simulate(on_rig, seed)
        compared, models = compare_models(data, how)
        measured = measure_control(data["sweep"], bench, models, controllers(how.models))
    except FprcError as error:
        return [{"seed": seed, "failed": in_one_line(error)}]
    source = {"source": "sim"}
    return [{"seed": seed, "compared": compared | source, "measured": measured | source}]


def draw_rig(seed: int, free: Sequence[Free], on_rig: RigSettings) -> RigSettings:
    """Draw rigs until one bends and squeezes plausibly; return ``on_rig`` with that rig.

    Free parameters are uniform over their ranges, or log-uniform where a range
    spans a decade; all others are as in ``on_rig``.

    Raises
    ------
    EvaluationError
        None of 2000 rigs is plausible.
    """
    # a second seed: default_rng(seed) alone also draws the sensors' errors
    rng = np.random.default_rng([seed, _PARAMETERS])
    sweep = {"sweep": on_rig.signals["sweep"]}
    for _ in range(_MOST_DRAWS):
        rig = decode(rng.uniform(size=len(free)), on_rig.rig, free)
        try:
            Rig.model_validate(rig)
            logs = simulate(on_rig.changed(rig=rig, signals=sweep), seed)
            measured = properties(logs["sweep"].channels)
        except (ValidationError, FprcError):
            continue
        if all(low <= measured[name] <= high for name, (low, high) in ACCEPTED.items()):
            return on_rig.changed(rig=rig)
    raise EvaluationError(
        f"none of {_MOST_DRAWS} rigs bends by {ACCEPTED['angle_deg']} deg and swings P_o by "
        f"{ACCEPTED['p_o_swing_kpa']} kPa; change calibration.ranges or calibration.free"
    )
