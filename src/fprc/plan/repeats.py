"""Repeats of the fit, and the tests that say which of them land."""

import json
from collections.abc import Container, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from fprc.errors import FprcError


class LandingTest(NamedTuple):
    """One test of repeats, see docs/preregistration.md#repeats-of-the-fit."""

    rigs: tuple[str, ...]  #: repeats in the table
    seeds: range  #: seeds that judge them
    limits: Mapping[str, Any]  #: fields of ``fprc.tables.repeats.Limits``
    spread_of: tuple[str, ...] = ()  #: repeats whose spread gives the limit of the median


_LIMITS = {"largest": 0.30, "points": 9, "worth": (0.60, 0.82)}
_FIRST_SEEDS, _FIRST_LIMITS = range(501, 511), {"median": 0.08, **_LIMITS}
_SPREAD_SEEDS = range(521, 541)
_SPREAD_OF = tuple(f"again_from_pilot_{number}" for number in (3, 4, 5, 6))


def landing_tests(fitted_on: Mapping[str, Sequence[int]]) -> dict[str, LandingTest]:
    """Return the tests of repeats, by the name of their table.

    Parameters
    ----------
    fitted_on : Mapping
        Seeds of each repeat, by its name.

    Returns
    -------
    dict
        ``repeats``, by the first limits; and ``spread``, by the spread of four repeats, if these
        are there. Repeats with fewer seeds than the four are not in ``spread``.
    """
    tests = {"repeats": LandingTest(tuple(fitted_on), _FIRST_SEEDS, _FIRST_LIMITS)}
    if fitted_on.keys() >= set(_SPREAD_OF):
        least = min(len(fitted_on[name]) for name in _SPREAD_OF)
        rigs = tuple(name for name, seeds in fitted_on.items() if len(seeds) >= least)
        tests["spread"] = LandingTest(rigs, _SPREAD_SEEDS, _LIMITS, _SPREAD_OF)
    return tests


def read_repeats(folder: Path, taken: Container[str] = ()) -> dict[str, list[int]]:
    """Return the seeds that each repeat in a folder was fitted on, by its name.

    Parameters
    ----------
    folder : Path
        Rigs, YAML, each with the report of its fit, JSON.
    taken : container of str
        Names of other rigs.

    Raises
    ------
    FprcError
        There is no repeat; or one has a name that is taken, its report is missing or damaged, its
        fit ran out of time, or it used seeds that judge the repeats. Lists all errors.
    """
    fitted_on, errors = {}, []
    for rig in sorted(folder.glob("*.yaml")):
        report = rig.with_suffix(".json")
        if rig.stem in taken:
            errors.append(f"{rig}: another rig is called {rig.stem}; rename this one and its .json")
        try:
            found = json.loads(report.read_text(encoding="utf-8"))
            seeds, finished = list(found["seeds"]), found["finished"]
        except FileNotFoundError:
            errors.append(f"{report}: missing; `fprc calibrate` writes it beside {rig.name}")
            continue
        except (ValueError, KeyError, TypeError):
            errors.append(
                f"{report}: not a report of `fprc calibrate`; put that of {rig.name} there"
            )
            continue
        if not finished:
            errors.append(f"{report}: the fit ran out of time; repeat it with a longer --minutes")
        if judging := sorted({*_FIRST_SEEDS, *_SPREAD_SEEDS}.intersection(seeds)):
            errors.append(
                f"{report}: fitted on seeds that judge repeats: {', '.join(map(str, judging))}; "
                "fit it on others (calibration.seeds)"
            )
        fitted_on[rig.stem] = seeds
    if not (fitted_on or errors):
        errors = [f"{folder}: no repeat of the fit there; see docs/searches.md"]
    if errors:
        raise FprcError("\n".join(errors))
    return fitted_on
