"""The fitted rigs side by side: errors, and verdicts of the claims."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.paper import ERRORS, REFERENCE_NAMES
from fprc.registry import controller_title, title_of
from fprc.tables.models import over_seeds
from fprc.tables.text import format_mean, spread, three_digits
from fprc.tables.tracking import tracking_over_seeds

_MEDIAN = "Tables II and III, 5 % in the median"
_LARGEST = "Tables II and III, 15 % at most"
_OPEN_LOOP = "Table IV, open loop, 15 % at most"
_CLOSED_LOOP = "Table IV, closed loop, 35 % at most"

#: What the reservoir is worth: the number of claim B1.
_WORTH = "FPRC / FPRC on low-passed theta_d, test RMSE"

#: How far each seed's training and test errors are off print.
_DEVIATION = "Tables II and III, training and test errors of single seeds"


def all_over_seeds(
    models: Sequence[Mapping[str, Any]],
    controls: Sequence[Mapping[str, Any]],
    published: Mapping[str, Any],
) -> pd.DataFrame:
    """Tables II to IV over further seeds in one: ``table``, ``what``, ``unit``, ``mean``, ..."""
    parts = []
    for number, trained_on in (("II", "sweep"), ("III", "complex")):
        part = over_seeds(models, published, trained_on)
        what = [f"{title_of(row.model)}, {ERRORS[row.metric]}" for row in part.itertuples()]
        parts.append(part.assign(table=number, what=what))
    runs = tracking_over_seeds(controls, published).rename(columns={"rmse_deg": "mean"})
    what = [
        f"{controller_title(row.controller)}, {REFERENCE_NAMES[row.reference]}"
        for row in runs.itertuples()
    ]
    runs["published_mean"] = runs["published_rmse_deg"].astype(float)
    table = pd.concat([*parts, runs.assign(table="IV", what=what, unit="deg")], ignore_index=True)
    return table.rename(columns={"published_mean": "published"})


def rig_errors(
    models: Sequence[Mapping[str, Any]],
    controls: Sequence[Mapping[str, Any]],
    published: Mapping[str, Any],
) -> pd.DataFrame:
    """Return the errors of Tables II to IV on one rig that the paper prints, tidy.

    Columns ``number``, ``published``, ``mean``, ``low``, ``high``, and ``deviation``, which is
    ours / print - 1.
    """
    table = all_over_seeds(models, controls, published)
    table = table[table["published"].notna()]
    number = "Table " + table["table"] + ", " + table["what"] + " [" + table["unit"] + "]"
    table = table.assign(number=number, deviation=table["mean"] / table["published"] - 1.0)
    columns = ["number", "published", "mean", "low", "high", "deviation"]
    return table[columns].reset_index(drop=True)


def within_limits(errors: pd.DataFrame) -> dict[str, bool]:
    """Return which limits the deviations from the printed errors are within, by their text.

    Parameters
    ----------
    errors : DataFrame
        Result of ``rig_errors``.
    """
    tables, open_loop, closed_loop = deviations_of(errors)
    near = {_MEDIAN: tables.median() <= 0.05, _LARGEST: tables.max() <= 0.15}
    tracking = {_OPEN_LOOP: open_loop.max() <= 0.15, _CLOSED_LOOP: closed_loop.max() <= 0.35}
    both = {
        "Tables II and III, both limits": all(near.values()),
        "Table IV, both limits": all(tracking.values()),
    }
    met = near | tracking | both | {"all four limits": all(both.values())}
    return {name: bool(value) for name, value in met.items()}


def deviations_of(errors: pd.DataFrame) -> tuple[pd.Series, pd.Series, pd.Series]:
    """Return absolute deviations, as shares: Tables II and III, Table IV open and closed loop.

    Parameters
    ----------
    errors : DataFrame
        Result of ``rig_errors``.

    Raises
    ------
    ValueError
        One of the three has no errors, or one that is not a number.
    """
    off, number = errors["deviation"].abs(), errors["number"]
    parts = (
        off[~number.str.startswith("Table IV")],
        off[number.str.startswith("Table IV, FPRC,")],
        off[number.str.startswith("Table IV, FPRC+PD,")],
    )
    if any(part.empty or part.isna().any() for part in parts):
        raise ValueError(f"a deviation of Tables II to IV is missing: {', '.join(number)}")
    return parts


def _sums(
    errors: pd.DataFrame, ledger: Sequence[Mapping[str, str]], deviation: float
) -> dict[str, str]:
    off, open_loop, closed_loop = deviations_of(errors)
    return {
        _DEVIATION: f"{100 * deviation:.0f} % (rms)",
        "Tables II and III, median deviation": f"{100 * off.median():.0f} %",
        "Tables II and III, largest deviation": f"{100 * off.max():.0f} %",
        "Table IV, open loop, largest deviation": f"{100 * open_loop.max():.0f} %",
        "Table IV, closed loop, largest deviation": f"{100 * closed_loop.max():.0f} %",
        _WORTH: next((row["ours"].rpartition(": ")[2] for row in ledger if row["id"] == "B1"), ""),
    }


def rigs_page(
    errors: Mapping[str, pd.DataFrame],
    ledgers: Mapping[str, Sequence[Mapping[str, str]]],
    deviations: Mapping[str, float],
) -> pd.DataFrame:
    """Return errors and verdicts, a column per rig.

    Parameters
    ----------
    errors : Mapping
        Result of ``rig_errors``, by rig.
    ledgers : Mapping
        ``id``, ``claim``, ``verdict`` and ``rig`` (fitted, predicted, ...) of each claim, by rig.
    deviations : Mapping
        Root mean square of the logarithms of each seed's training and test errors over the printed
        ones, by rig.
    """
    first = next(iter(errors))
    page = pd.DataFrame(
        {
            "Number or claim": errors[first]["number"],
            "Paper": [spread(value, None) for value in errors[first]["published"]],
        }
    )
    for name, table in errors.items():
        page[f"Rig {name}"] = [
            f"{format_mean(row, 'mean')}, {100 * row['deviation']:+.0f} %"
            for row in table.to_dict("records")
        ]
    claims = pd.DataFrame(
        {
            "Number or claim": [f"{row['id']}: {row['claim']}" for row in ledgers[first]],
            "Paper": "holds",
            **{
                f"Rig {name}": [f"{row['verdict']} ({row['rig']})" for row in ledger]
                for name, ledger in ledgers.items()
            },
        }
    )
    sums = {name: _sums(errors[name], ledgers[name], off) for name, off in deviations.items()}
    summed = pd.DataFrame(
        {
            "Number or claim": list(sums[first]),
            "Paper": "",
            **{f"Rig {name}": list(own.values()) for name, own in sums.items()},
        }
    )
    return pd.concat([page, summed, claims], ignore_index=True)


def rigs_answer(rigs: pd.DataFrame, sets: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return in a few rows how far each rig is off print, and what the reservoir is worth on it.

    Parameters
    ----------
    rigs : DataFrame
        As ``rigs_page`` returns it, with the claims of the paper and B1.
    sets : sequence of mapping
        Summaries of sets of rigs, see ``fprc.studies.stages.rigs.summarise_rigs``.

    Returns
    -------
    DataFrame
        A row per rig, then a row per set.
    """
    page = rigs.set_index("Number or claim")
    claims = page.index.str.match(r"C\d+[a-z]?: ")
    rows = []
    for column in page.columns.drop("Paper"):
        own = page[column]
        verdicts = own[claims].str.partition(" (")[0].value_counts()
        open_loop = own["Table IV, open loop, largest deviation"]
        rows.append(
            (
                column,
                own[_DEVIATION],
                f"{open_loop} at most",
                ", ".join(f"{count} {verdict}" for verdict, count in verdicts.items()),
                own[_WORTH],
                own[page.index.str.startswith("B1: ")].iloc[0],
            )
        )
    for summary in sets:
        middle, low, high = map(three_digits, summary["worth"])
        claim = next(each for each in summary["claims"] if each["id"] == "B1")
        share, least, most = (f"{100 * claim[key]:.0f}" for key in ("share", "low", "high"))
        rows.append(
            (
                f"{claim['rigs']} {summary['drawn'].partition(';')[0]}",
                f"{100 * summary['deviation']:.0f} % (rms)",
                "-",
                "-",
                f"median {middle}, 95 % of the rigs {low} to {high}",
                f"holds on {claim['holds']}: {share} % ({least} to {most})",
            )
        )
    off, wins = "Tables II and III off print", "P_o beats low-passed theta_d (B1)"
    columns = ["Rigs", off, "Open-loop Table IV off print", "Claims", _WORTH, wins]
    return pd.DataFrame(rows, columns=columns)
