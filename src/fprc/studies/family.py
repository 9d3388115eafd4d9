"""Families of simulated rigs: one rig with many seeds, or the ensemble of rigs that fit print.

A unit of a family is a seed, if it has one rig, else a rig.
"""

from collections.abc import Mapping
from pkgutil import resolve_name
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
from fprc.studies.calibration.space import with_values


class Unit(NamedTuple):
    """A unit of a family, to be simulated with one seed."""

    number: int  #: from 0
    on_rig: RigSettings
    seed: int
    every_model: bool  #: whether ``contest`` judges all models, or those that a claim compares


def unit_of(number: int, family: Mapping[str, Any], first_seed: int) -> Unit:
    """Return a unit of a family, with its rig and seed.

    A family has its ``name``, ``on_rig`` (arguments of ``RigSettings``), what it is ``fitted`` to,
    ``every_model``, and ``members``: its rigs, as ``fprc calibrate --ensemble`` writes them, or
    None if it has one. What members share has its default.
    """
    on_rig = RigSettings(**family["on_rig"])
    if known := family["members"]:
        if number >= len(known["rigs"]):
            raise FprcError(f"{family['name']} has {len(known['rigs'])} rigs; reduce beyond.units")
        values = dict(zip(known["parameters"], known["rigs"][number], strict=True))
        rig = Rig.model_validate(with_values(Rig().model_dump(mode="json"), values))
        on_rig = on_rig.changed(rig=rig.model_dump(mode="json"))
    return Unit(number, on_rig, first_seed + number, family["every_model"])


def judge_family(
    judged: str, *, family: Mapping[str, Any], study: Mapping[str, Any], workers: int
) -> None:
    """Judge the first units of a family of rigs, each on one thread.

    A study has the number of ``units``, their ``first_seed``, and what judges one: ``judge``, a
    function below ``fprc.studies`` as ``learning.judge_online``, which takes a ``Unit`` and
    ``how``, and returns a JSON mapping. Writes the family's ``name``, what it is ``fitted`` to, and
    ``cells``: of each ``unit`` its ``seed`` and what was found, or ``failed``, an error's message.
    """
    # to start a process takes as long as several units
    workers = max(1, min(workers, study["units"] // 4))
    with parallel_config("loky", inner_max_num_threads=1):
        cells = Parallel(n_jobs=workers)(
            delayed(_judged)(unit_of(number, family, study["first_seed"]), study)
            for number in range(study["units"])
        )
    described = {key: family[key] for key in ("name", "fitted")}
    write_json(judged, {"source": "sim", **described, "cells": cells})


def _judged(unit: Unit, study: Mapping[str, Any]) -> dict[str, Any]:
    try:
        found = resolve_name(f"fprc.studies.{study['judge']}")(unit, **study["how"])
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
