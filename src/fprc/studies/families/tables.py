"""Families side by side: errors, and verdicts of the claims."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.paper import ERRORS, REFERENCE_NAMES
from fprc.registry import controller_title, title_of
from fprc.tables.models import over_seeds
from fprc.tables.text import format_mean, spread
from fprc.tables.tracking import tracking_over_seeds

#: What the middle and the range of a family's numbers are.
_RANGES = (
    "Of one rig: mean and its 95 % interval over seeds. Of many rigs, one recording of each: "
    "median and 95 % of the rigs."
)

#: Sums of deviations from print, shares, in the order of the table.
SUMS = {
    "median": "Tables II and III, median deviation",
    "largest": "Tables II and III, largest deviation",
    "open_loop": "Table IV, open loop, largest deviation",
    "closed_loop_median": "Table IV, closed loop, median deviation",
    "closed_loop": "Table IV, closed loop, largest deviation",
}


def rig_errors(
    models: Sequence[Mapping[str, Any]],
    controls: Sequence[Mapping[str, Any]],
    published: Mapping[str, Any],
) -> pd.DataFrame:
    """Return the errors of Tables II to IV on one rig that the paper prints, tidy.

    Among the columns are ``number``, ``table``, ``controller``, ``published``, ``mean``, ``low``,
    ``high``, and ``deviation``, which is ours / print - 1.
    """
    tables = []
    for number, log in (("II", "sweep"), ("III", "complex")):
        errors = over_seeds(models, published, log).rename(columns={"published_mean": "published"})
        what = errors["model"].map(title_of) + ", " + errors["metric"].map(ERRORS)
        tables.append(errors.assign(table=number, what=what))
    loops = tracking_over_seeds(controls, published).rename(
        columns={"rmse_deg": "mean", "published_rmse_deg": "published"}
    )
    of_loops = loops["controller"].map(controller_title), loops["reference"].map(REFERENCE_NAMES)
    tables.append(loops.assign(table="IV", unit="deg", what=of_loops[0] + ", " + of_loops[1]))
    table = pd.concat(tables).dropna(subset="published").reset_index(drop=True)
    return table.assign(
        number="Table " + table["table"] + ", " + table["what"] + " [" + table["unit"] + "]",
        deviation=table["mean"] / table["published"] - 1.0,
    )


def sums_of(errors: pd.DataFrame) -> dict[str, float]:
    """Return the deviations from print in a few numbers, absolute, as shares, by ``SUMS``.

    Parameters
    ----------
    errors : DataFrame
        Result of ``rig_errors``.
    """
    off, table, controller = errors["deviation"].abs(), errors["table"], errors["controller"]
    tables, closed_loop = off[table != "IV"], off[controller == "fprc_pd"]
    return {
        "median": tables.median(),
        "largest": tables.max(),
        "open_loop": off[controller == "fprc"].max(),
        "closed_loop_median": closed_loop.median(),
        "closed_loop": closed_loop.max(),
    }


Families = Sequence[Mapping[str, Any]]  #: see ``fprc.studies.stages.families.compare_families``


def _errors(families: Families) -> tuple[pd.DataFrame, str]:
    """Return the errors that the paper prints, and sums of deviations, a column per family."""
    first = families[0]["errors"]
    page = pd.DataFrame(
        {
            "Number": [*(row["number"] for row in first), *SUMS.values()],
            "Paper": [*(spread(row["published"], None) for row in first), *("" for _ in SUMS)],
        }
    )
    for family in families:
        page[family["title"]] = [
            *(
                f"{format_mean(row, 'middle')}, "
                f"{100 * (row['middle'] / row['published'] - 1.0):+.0f} %"
                for row in family["errors"]
            ),
            *(_percent(family["sums"][name]) for name in SUMS),
        ]
    return page, f"Families of rigs: errors, and their deviation from print. {_RANGES}"


def _claims(families: Families) -> tuple[pd.DataFrame, str]:
    """Return the verdicts of all claims, a column per family."""
    first = families[0]["claims"]
    page = pd.DataFrame({"Id": [c["id"] for c in first], "Claim": [c["claim"] for c in first]})
    for family in families:
        known = {claim["id"]: claim for claim in family["claims"]}
        page[family["title"]] = [_verdict(known.get(name)) for name in page["Id"]]
    note = (
        "Claims on families of rigs. Of one rig: the verdict over seeds, and whether the rig was "
        "fitted to the claim. Of many rigs: on how many the claim holds, and the share with its "
        "95 % interval, which does not cover the choice of how the rigs were found; grids are not "
        "judged on them."
    )
    return page, note


#: Of each table: from the families to its page and a note; the summary has the numbers.
TABLES = {"errors": _errors, "claims": _claims}


def _verdict(claim: Mapping[str, Any] | None) -> str:
    if claim is None:
        return "-"
    if (held := claim["holds"]) is None:
        return f"{claim['verdict']} ({claim['rig']})"
    return (
        f"{held['holds']} of {held['rigs']}: {100 * held['share']:.0f} % "
        f"({100 * held['low']:.0f} to {100 * held['high']:.0f})"
    )


def _percent(values: Sequence[float]) -> str:
    """Return the median of a share over units, with its range if there are several."""
    middle, low, high = (f"{100 * value:.0f}" for value in values)
    return f"{middle} %" if low == high else f"{middle} % ({low} to {high})"
