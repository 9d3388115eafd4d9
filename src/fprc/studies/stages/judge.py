"""Judge a family of simulated rigs with any function of the studies."""

from collections.abc import Mapping, Sequence
from functools import partial
from importlib import import_module
from typing import Any

from fprc.artifacts import write_json
from fprc.evaluation.cells import run_cells
from fprc.studies.families.family import unit_of


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

    Writes the family's ``name``, what it is ``fitted`` to, and ``cells``, all that the function
    found, each with its ``unit``.

    Parameters
    ----------
    ensemble : str
        File of the ensemble, if the family has them.
    judge : str
        Function below ``fprc.studies``, such as ``online.judge.judge_online``. It takes a
        ``fprc.experiments.settings.Unit`` and ``how``, and returns a list of JSON mappings.
    family : Mapping
        See ``fprc.studies.families.family.unit_of``; also ``name`` and ``fitted``.
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
        found = [{"unit": cell["unit"], **row} for cell in cells for row in cell["found"]]
        described = {key: family[key] for key in ("name", "fitted")}
        write_json(judged, {"source": "sim", **described, "cells": found})


def _judge(
    cell: Mapping[str, Any],
    *,
    judge: str,
    family: Mapping[str, Any],
    ensemble: str,
    how: Mapping[str, Any],
) -> dict[str, Any]:
    module, _, function = judge.rpartition(".")
    judged_by = getattr(import_module(f"fprc.studies.{module}"), function)
    return {"found": judged_by(unit_of(cell["unit"], family, ensemble), **how)}
