"""Judge a family of simulated rigs with any function of the studies."""

from collections.abc import Mapping, Sequence
from functools import partial
from importlib import import_module
from typing import Any

import numpy as np

from fprc.artifacts import write_json
from fprc.errors import FprcError
from fprc.evaluation.cells import judged_cells
from fprc.studies.families.family import unit_of
from fprc.yaml_file import read_yaml


def judge_family(
    judged: str,
    near_print: str = "",
    tuned: str = "",
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
    near_print : str
        File of the rigs near print, if the family has them.
    tuned : str
        Settings of the tuned models, by family and name, if the function needs them.
    judge : str
        Function below ``fprc.studies``, such as ``online.judge.judge_online``. It takes a
        ``fprc.experiments.settings.Unit`` and ``how``, and returns a list of JSON mappings.
    family : Mapping
        See ``fprc.studies.families.family.unit_of``; also ``name`` and ``fitted``.
    workers : int
        Most processes.
    **run
        ``checkpoint`` and ``version`` of ``judged_cells``.
    """
    if tuned:
        family = {**family, "tuned": _tuned(tuned, family, units)}
    with judged_cells(
        partial(_judge, judge=judge, family=family, near_print=near_print, how=how),
        [{"unit": unit} for unit in units],
        settings=[family, how],
        files=[near_print] if near_print else [],
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
    near_print: str,
    how: Mapping[str, Any],
) -> dict[str, Any]:
    module, _, function = judge.rpartition(".")
    judged_by = getattr(import_module(f"fprc.studies.{module}"), function)
    return {"found": judged_by(unit_of(cell["unit"], family, near_print), **how)}


def _tuned(path: str, family: Mapping[str, Any], units: Sequence[int]) -> Any:
    """Return the settings of the tuned models, which must be judged on other data."""
    feedforward = family["on_rig"]["control"]["feedforward"]
    if feedforward["adapt"] or feedforward["p_o_shift_kpa"]:
        raise FprcError(
            "control.feedforward: the comparison beyond the paper is of models that do not learn, "
            "and has its own offsets of P_o; set adapt to false and p_o_shift_kpa to 0"
        )
    known = read_yaml(path)
    if family["name"] not in known:
        raise FprcError(
            f"{path}: no settings for the family {family['name']}; add them to config/tuned.yaml"
        )
    kind, judged = "rigs", set(units)
    if family["rigs"] == "one":
        per_unit = family["seeds_per_rig"]
        seeds = np.add.outer(family["first_seed"] + per_unit * np.array(units), range(per_unit))
        kind, judged = "seeds", set(seeds.ravel().tolist())
    if twice := judged.intersection(known["chosen_on"][kind]):
        raise FprcError(
            f"{path}: its settings were chosen on the {kind} {sorted(twice)}, which would judge "
            "them too; reduce beyond.units or, of seeds, change beyond.first_seed"
        )
    return known[family["name"]]
