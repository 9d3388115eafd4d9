"""Repeats of the fit, the tests that say which of them land, and fits with other settings."""

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
_BESIDE = (*_SPREAD_OF, "again_from_pilot_7", "again_from_pilot_8")


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


class Variants(NamedTuple):
    """Fits with other settings, to be compared with the spread of repeats."""

    repeats: tuple[str, ...]
    variants: tuple[str, ...]
    seeds: range  #: seeds that judge all of them

    @property
    def rigs(self) -> tuple[str, ...]:
        """The repeats, then the variants."""
        return self.repeats + self.variants


def variants_beside(
    repeats: Mapping[str, Sequence[int]], variants: Mapping[str, Sequence[int]]
) -> Variants:
    """Return fits with other settings beside the repeats with twelve seeds, from the pilot's rig.

    Parameters
    ----------
    repeats, variants : Mapping
        Seeds of each fit, by its name.

    Raises
    ------
    FprcError
        There are no variants, some of the repeats are missing, or a variant was fitted on fewer
        seeds than they were. Lists all errors.
    """
    errors = []
    if not variants:
        errors.append("no fit with other settings is there; see docs/searches.md")
    if missing := [name for name in _BESIDE if name not in repeats]:
        errors.append(f"the repeats {', '.join(missing)} are missing; restore them")
    least = min((len(repeats[name]) for name in _BESIDE if name in repeats), default=0)
    errors += [
        f"{name}: fitted on {len(seeds)} seeds, and the repeats on {least}; fit it on as many"
        for name, seeds in variants.items()
        if len(seeds) < least
    ]
    if errors:
        raise FprcError("\n".join(errors))
    return Variants(_BESIDE, tuple(variants), _FIRST_SEEDS)


def read_fits(folder: Path, taken: Container[str] = ()) -> dict[str, list[int]]:
    """Return the seeds of each fit in a folder, by its name.

    Parameters
    ----------
    folder : Path
        Repeats of the fit, or fits with other settings: rigs, YAML, each with the report of its
        fit, JSON.
    taken : container of str
        Names of other rigs.

    Raises
    ------
    FprcError
        A name is taken, a report is missing or damaged, or a fit ran out of time or used seeds that
        judge repeats. Lists all errors.
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
    if errors:
        raise FprcError("\n".join(errors))
    return fitted_on
