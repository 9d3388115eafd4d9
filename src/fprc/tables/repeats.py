"""Repeats of the fit and fits with other settings, within limits or beyond the repeats' spread."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from scipy.special import stdtrit

from fprc.paper import PRINTED
from fprc.tables.models import samples
from fprc.tables.rigs import deviations_of, points
from fprc.tables.text import three_digits

#: Resamples of the seeds behind the interval of a median deviation.
_RESAMPLES = 10_000

#: What a fit with other settings may have beyond the spread of repeats: 1 more of it, -1 less.
_SIDES = {"median": 1, "largest": 1, "open loop": 1, "closed loop": -1, "points": -1}


class Limits(NamedTuple):
    """Limits within which a repeat lands, see docs/preregistration.md; ends are within."""

    median: float  #: upper limit of the median absolute deviation of the 18 errors, as a share
    largest: float  #: upper limit of their largest absolute deviation, as a share
    points: int  #: lower limit of the points of the rule that chose the shipped rig
    worth: tuple[float, float]  #: ends of FPRC's test RMSE over that on low-passed theta_d


def numbers_of_repeat(
    models: Sequence[Mapping[str, Any]],
    errors: pd.DataFrame,
    ledger: Sequence[Mapping[str, Any]],
    published: Mapping[str, Any],
) -> dict[str, Any]:
    """Return the numbers of one rig that its limits are about, and its verdicts.

    Parameters
    ----------
    models : sequence of mapping
        Reports on the models, one per seed.
    errors : DataFrame
        Result of ``rig_errors`` on the same seeds.
    ledger : sequence of mapping
        Verdicts, with C4b among them.
    published : Mapping
        What the paper prints.

    Returns
    -------
    dict
        ``median`` and ``largest`` of the absolute deviations of Tables II and III, as shares;
        ``median_low`` and ``median_high``, the 95 % percentile bootstrap interval over the seeds,
        which with ten or twenty seeds is somewhat too short; ``open loop`` and ``closed loop``, the
        largest absolute deviation of Table IV; ``points`` of the rule; ``worth``, the ratio of C4b,
        with ``worth_low`` and ``worth_high``; and the claims that are ``not reproduced`` and
        ``undecided``.
    """
    off, open_loop, closed_loop = deviations_of(errors)
    ratios = _over_print(models, published)
    resampled = np.random.default_rng(0).integers(len(ratios), size=(_RESAMPLES, len(ratios)))
    medians = np.median(np.abs(ratios[resampled].mean(axis=1) - 1.0), axis=1)
    low, high = np.quantile(medians, (0.025, 0.975))
    (worth,) = next(row["statements"] for row in ledger if row["id"] == "C4b")
    return {
        "median": float(off.median()),
        "median_low": float(low),
        "median_high": float(high),
        "largest": float(off.max()),
        "open loop": float(open_loop.max()),
        "closed loop": float(closed_loop.max()),
        "points": points(errors, ledger),
        "worth": worth["mean"],
        "worth_low": worth["first"],
        "worth_high": worth["last"],
        **{
            verdict: ", ".join(row["id"] for row in ledger if row["verdict"] == verdict) or "none"
            for verdict in ("not reproduced", "undecided")
        },
    }


def _over_print(models: Sequence[Mapping[str, Any]], published: Mapping[str, Any]) -> np.ndarray:
    """Return the 18 errors of Tables II and III over the printed ones, shape (seeds, 18)."""
    errors = pd.concat([samples(models, published, log) for log in PRINTED])
    errors = errors.dropna(subset="published_mean").sort_values("replicate", kind="stable")
    return (errors["value"] / errors["published_mean"]).to_numpy().reshape(len(models), -1)


def upper_end(values: Sequence[float]) -> float:
    """Return the upper end of the one-sided 95 % prediction interval for one more value.

    The values are taken to be normal: ``m + t s sqrt(1 + 1/n)``, with Student's t.

    Raises
    ------
    ValueError
        There are fewer than two values.
    """
    n = len(values)
    if n < 2:
        raise ValueError(f"{n} values have no spread; give at least two")
    return float(
        np.mean(values) + stdtrit(n - 1, 0.95) * np.std(values, ddof=1) * np.sqrt(1 + 1 / n)
    )


def beyond_limits(numbers: Mapping[str, Any], limits: Limits) -> list[str]:
    """Return the names of the limits that a repeat misses; it lands if there are none."""
    low, high = limits.worth
    within = {
        "median": numbers["median"] <= limits.median,
        "largest": numbers["largest"] <= limits.largest,
        "points": numbers["points"] >= limits.points,
        "ratio": low <= numbers["worth"] <= high,
    }
    return [name for name, holds in within.items() if not holds]


def ends_of_spread(repeats: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """Return the end of the one-sided 95 % prediction interval for one more repeat.

    Parameters
    ----------
    repeats : sequence of mapping
        Results of ``numbers_of_repeat``.

    Returns
    -------
    dict
        The upper ends of ``median``, ``largest`` and ``open loop``, and the lower ends of
        ``closed loop`` and ``points``; see docs/preregistration.md.

    Raises
    ------
    ValueError
        There are fewer than two repeats.
    """
    return {
        name: side * upper_end([side * own[name] for own in repeats])
        for name, side in _SIDES.items()
    }


def beyond_spread(numbers: Mapping[str, Any], ends: Mapping[str, float]) -> list[str]:
    """Return what of a fit is beyond the ends that ``ends_of_spread`` returns."""
    return [name for name, side in _SIDES.items() if side * numbers[name] > side * ends[name]]


def repeats_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table of the repeats as a page."""
    return _page(table).assign(Lands=table["lands"])


def variants_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table of repeats and fits with other settings as a page."""
    page = _page(table)
    for name in ("closed loop", "open loop"):
        page.insert(3, f"Table IV, {name}", [f"{100 * value:.1f} %" for value in table[name]])
    return page.assign(**{"Beyond the spread": table["beyond"]})


def _page(table: pd.DataFrame) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "Rig": table["rig"],
            "Median deviation": [
                "{:.2f} % ({:.1f} to {:.1f})".format(*row)
                for row in 100 * table[["median", "median_low", "median_high"]].to_numpy()
            ],
            "Largest": [f"{100 * value:.1f} %" for value in table["largest"]],
            "Points": table["points"].map(str),
            "FPRC / FPRC on low-passed theta_d": [
                "{} ({} to {})".format(*map(three_digits, row))
                for row in table[["worth", "worth_low", "worth_high"]].to_numpy()
            ],
            "Not reproduced": table["not reproduced"],
            "Undecided": table["undecided"],
        }
    )
