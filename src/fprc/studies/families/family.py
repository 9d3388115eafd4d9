"""Families of simulated rigs: one rig with many seeds, or the ensemble of rigs that fit print.

A unit of a family is a seed, if it has one rig, else a rig.
"""

from collections.abc import Mapping
from typing import Any

from fprc.artifacts import read_json
from fprc.config.rig import Rig
from fprc.config.tracking import Tracking
from fprc.errors import FprcError, in_one_line
from fprc.experiments.comparison import compare_models
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import CrossValidation, RigSettings, Unit
from fprc.experiments.tracking import Track, measure_control
from fprc.registry import controllers
from fprc.studies.calibration.space import with_values


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
    return Unit(number, family, [(on_rig, family["first_seed"] + number)])


def judge_tables(
    unit: Unit, *, tracking: Mapping[str, Any], validation: Mapping[str, Any]
) -> list[dict[str, Any]]:
    """Judge the rig of a unit with the full models, on the first of its seeds.

    Parameters
    ----------
    validation : Mapping
        Arguments of ``CrossValidation`` without the seed.

    Returns
    -------
    list of one dict
        ``seed``, and ``compared`` (Tables II and III) and ``measured`` (Table IV); or
        ``failed`` instead of these two, where an error ended it.
    """
    on_rig, seed = unit.rigs[0]
    how = CrossValidation(**validation, seed=seed)
    bench = Track(Tracking(**tracking), on_rig.control, on_rig.rig, seed)
    try:
        data = simulate(on_rig, seed)
        compared, models = compare_models(data, how)
        measured = measure_control(data["sweep"], bench, models, controllers(how.models))
    except FprcError as error:
        return [{"seed": seed, "failed": in_one_line(error)}]
    source = {"source": "sim"}
    return [{"seed": seed, "compared": compared | source, "measured": measured | source}]
