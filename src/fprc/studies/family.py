"""Families of simulated rigs: one rig with many seeds, or the ensemble of rigs that fit print.

A unit of a family is a seed, if it has one rig, else a rig.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from joblib import Parallel, delayed, parallel_config

from fprc.artifacts import write_json
from fprc.claims.ledger import Results, members_of
from fprc.claims.paper import CLAIMS
from fprc.config.rig import Rig
from fprc.config.settings import Tracking
from fprc.errors import FprcError, in_one_line
from fprc.experiments.comparison import CrossValidation, compare_models
from fprc.experiments.data import RigSettings, simulate
from fprc.experiments.tracking import Track, measure_control
from fprc.given import read_json
from fprc.registry import controllers
from fprc.stages.run import stage_of
from fprc.studies.calibration.space import with_values


class Unit(NamedTuple):
    """A unit of a family, to be simulated with one seed."""

    number: int  #: from 0
    family: Mapping[str, Any]  #: see ``unit_of``
    on_rig: RigSettings
    seed: int


def unit_of(number: int, family: Mapping[str, Any], ensemble: str = "") -> Unit:
    """Return a unit of a family, with its rig and seed.

    A family has ``rigs`` (one or ensemble), ``first_seed`` and ``on_rig`` (arguments of
    ``RigSettings``); ``fprc.studies.calibration.ensemble`` gives the file of the ensemble.
    """
    on_rig = RigSettings(**family["on_rig"])
    if family["rigs"] == "ensemble":
        known = read_json(ensemble)
        if number >= len(known["rigs"]):
            raise FprcError(f"{ensemble}: has {len(known['rigs'])} rigs; reduce beyond.units")
        # what the members share has its default
        whole = Rig().model_dump(mode="json")
        rig = with_values(whole, known["parameters"], known["rigs"][number])
        on_rig = on_rig.changed(rig=Rig.model_validate(rig).model_dump(mode="json"))
    return Unit(number, family, on_rig, family["first_seed"] + number)


def judge_family(
    judged: str,
    ensemble: str = "",
    *,
    judge: str,
    family: Mapping[str, Any],
    units: Sequence[int],
    how: Mapping[str, Any],
    workers: int,
) -> None:
    """Judge some units of a family of rigs with one function, each on one thread.

    Writes the family's ``name``, what it is ``fitted`` to, and ``cells``: of each ``unit`` its
    ``seed`` and what the function found, or ``failed``, the message of an error. The function
    ``judge``, below ``fprc.studies``, such as ``learning.judge_online``, takes a ``Unit`` and
    ``how``, and returns a JSON mapping.
    """
    # to start a process takes as long as several units
    workers = max(1, min(workers, len(units) // 4))
    with parallel_config("loky", inner_max_num_threads=1):
        cells = Parallel(n_jobs=workers)(
            delayed(_judged)(unit_of(number, family, ensemble), judge, how) for number in units
        )
    described = {key: family[key] for key in ("name", "fitted")}
    write_json(judged, {"source": "sim", **described, "cells": cells})


def _judged(unit: Unit, judge: str, how: Mapping[str, Any]) -> dict[str, Any]:
    try:
        found = stage_of(f"studies.{judge}")(unit, **how)
    except (FprcError, ValueError) as error:
        found = {"failed": in_one_line(error)}
    return {"unit": unit.number, "seed": unit.seed, **found}


def judge_tables(
    unit: Unit, *, tracking: Mapping[str, Any], validation: Mapping[str, Any]
) -> dict[str, Any]:
    """Return what Tables II and III (``compared``) and IV (``measured``) of a unit's rig rest on.

    ``validation`` has the arguments of ``CrossValidation``; the seed is the unit's.
    """
    how = CrossValidation(**{**validation, "seed": unit.seed})
    data = simulate(unit.on_rig, unit.seed)
    bench = Track(Tracking(**tracking), unit.on_rig.control, unit.on_rig.rig, unit.seed)
    compared, models = compare_models(data, how)
    measured = measure_control(data["sweep"], bench, models, controllers(how.models))
    return {"compared": compared, "measured": measured}


def count_members(judged: str, members: str) -> None:
    """Write on how many rigs that ``judge_tables`` has judged each claim holds.

    The claims are those that Tables II to IV, weights and loops decide; the others need grids or
    counts, or are assumed. ``fprc.claims.ledger.members_of`` says what is written.
    """
    claims = [claim for claim in CLAIMS if claim.over == "seeds" and claim.kind != "assumed"]
    rigs = [
        Results([cell["compared"]], [], [cell["measured"]], {}, {})
        for cell in read_json(judged)["cells"]
        if "failed" not in cell
    ]
    write_json(members, members_of(claims, rigs))
