"""Families of simulated rigs: one rig with many seeds, or the ensemble of rigs that fit print.

A unit of a family is a seed, if it has one rig, else a rig.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

from fprc.artifacts import read_json, write_json
from fprc.config.rig import Rig
from fprc.config.tracking import Tracking
from fprc.errors import FprcError, in_one_line
from fprc.evaluation.cells import run_cells
from fprc.experiments.comparison import compare_models
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import CrossValidation, RigSettings
from fprc.experiments.tracking import Track, measure_control
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

    Parameters
    ----------
    family : Mapping
        ``rigs`` (one or ensemble), ``first_seed`` and ``on_rig`` (arguments of ``RigSettings``).
    ensemble : str
        File of the ensemble, see ``fprc.studies.calibration.ensemble``.

    Raises
    ------
    FprcError
        The file has fewer rigs.
    """
    on_rig = RigSettings(**family["on_rig"])
    if family["rigs"] == "ensemble":
        known = read_json(ensemble)
        if number >= len(known["rigs"]):
            raise FprcError(
                f"{ensemble}: has {len(known['rigs'])} rigs, and rig {number} is needed; reduce "
                "beyond.units"
            )
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
    **run: Any,
) -> None:
    """Judge some units of a family of rigs with one function.

    Writes the family's ``name``, what it is ``fitted`` to, and ``cells``: of each ``unit`` its
    ``seed`` and what the function found, or ``failed``, the message of an error.

    Parameters
    ----------
    ensemble : str
        File of the ensemble, if the family has them.
    judge : str
        Function below ``fprc.studies``, such as ``online.judge.judge_online``. It takes a ``Unit``
        and ``how``, and returns a JSON mapping.
    family : Mapping
        See ``unit_of``; also ``name`` and ``fitted``.
    workers : int
        Most processes.
    **run
        ``checkpoint`` and ``version`` of ``run_cells``.
    """
    with run_cells(
        partial(_judge, judge=judge, family=family, ensemble=ensemble, how=how),
        [{"unit": unit} for unit in units],
        settings=[family, how],
        files=[ensemble] if ensemble else [],
        # to start a process takes as long as several units
        workers=max(1, min(workers, len(units) // 4)),
        **run,
    ) as cells:
        described = {key: family[key] for key in ("name", "fitted")}
        write_json(judged, {"source": "sim", **described, "cells": cells})


def _judge(
    cell: Mapping[str, Any],
    *,
    judge: str,
    family: Mapping[str, Any],
    ensemble: str,
    how: Mapping[str, Any],
) -> dict[str, Any]:
    unit = unit_of(cell["unit"], family, ensemble)
    try:
        found = stage_of(f"studies.{judge}")(unit, **how)
    except (FprcError, ValueError) as error:
        found = {"failed": in_one_line(error)}
    return {"seed": unit.seed, **found}


def judge_tables(
    unit: Unit, *, tracking: Mapping[str, Any], validation: Mapping[str, Any]
) -> dict[str, Any]:
    """Judge the rig of a unit with the full models.

    Parameters
    ----------
    validation : Mapping
        Arguments of ``CrossValidation`` without the seed.

    Returns
    -------
    dict
        ``compared`` (Tables II and III) and ``measured`` (Table IV).
    """
    how = CrossValidation(**validation, seed=unit.seed)
    bench = Track(Tracking(**tracking), unit.on_rig.control, unit.on_rig.rig, unit.seed)
    data = simulate(unit.on_rig, unit.seed)
    compared, models = compare_models(data, how)
    measured = measure_control(data["sweep"], bench, models, controllers(how.models))
    source = {"source": "sim"}
    return {"compared": compared | source, "measured": measured | source}
