"""Dependence of the results on the rig and on the models' target."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.errors import FprcError
from fprc.registry import title_of
from fprc.studies.families.rigs import all_over_seeds
from fprc.tables.text import format_mean, spread


def ensemble(summary: Mapping[str, Any]) -> pd.DataFrame:
    """Count the ensemble's rigs on which each claim holds, tidy.

    ``decided_by`` names the parameters whose rank correlation with the verdict
    exceeds the limit of chance; ``strongest`` names the parameter with the largest one.
    """
    rows = []
    for claim in summary["claims"]:
        ranked = sorted(claim["correlations"].items(), key=lambda item: -abs(item[1]))
        decisive = [pair for pair in ranked if abs(pair[1]) > claim["least_significant"]]
        rows.append(
            {
                key: claim[key]
                for key in ("id", "claim", "rig", "holds", "rigs", "share", "low", "high")
            }
            | {
                "decided_by": "; ".join(f"{path} ({rho:+.2f})" for path, rho in decisive),
                "strongest": f"{ranked[0][0]} ({ranked[0][1]:+.2f})" if ranked else "",
                "least_significant": claim["least_significant"],
                "source": summary["source"],
            }
        )
    return pd.DataFrame(rows)


def _share(row: Any, digits: int) -> str:
    share, low, high = (f"{100 * value:.{digits}f}" for value in (row.share, row.low, row.high))
    return f"{share} % ({low} to {high})"


def ensemble_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the ensemble's table as a page."""
    return pd.DataFrame(
        {
            "Claim": row.id,
            "Text": row.claim,
            "Fitted?": row.rig,
            "Holds on": f"{row.holds} of {row.rigs}",
            "Share, 95 % interval": _share(row, 0),
            "Decided by (rank correlation)": row.decided_by
            or (f"no parameter beyond chance; strongest {row.strongest}" if row.strongest else "-"),
        }
        for row in table.itertuples()
    )


def worth(summary: Mapping[str, Any]) -> pd.DataFrame:
    """How often P_o is worth more than a low-pass, on all rigs and on some, tidy.

    ``verdict`` is *yes* or *no* if the interval of the share lies above or below one half.
    """
    return pd.DataFrame(
        {
            "given": " and ".join(row["given"]),
            **{key: row[key] for key in ("holds", "rigs", "share", "low", "high")},
            "verdict": _side_of_one_half(row["low"], row["high"]),
            **dict(zip(("ratio", "ratio_low", "ratio_high"), row["ratio"], strict=True)),
            "p": row["p"],
            "matters": {True: "yes", False: "no", None: ""}[row["matters"]],
            "source": summary["source"],
        }
        for row in summary["worth_given"]
    )


def _side_of_one_half(low: float | None, high: float | None) -> str:
    if low is None or high is None:
        return "undecided"
    return "yes" if low > 0.5 else "no" if high < 0.5 else "undecided"


def worth_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table of P_o's worth as a page."""
    return pd.DataFrame(
        {
            "Rigs": f"with {row.given}" if row.given else "all",
            "B1 holds on": f"{row.holds} of {row.rigs}",
            "Share, 95 % interval": _share(row, 0) if row.rigs else "-",
            "On more than half?": row.verdict,
            "Ratio, median (smallest to largest)": f"{row.ratio:.2f} "
            f"({row.ratio_low:.2f} to {row.ratio_high:.2f})"
            if row.rigs
            else "-",
            "p": f"{row.p:.2g}" if row.matters else "-",
            "Matters?": row.matters or "-",
        }
        for row in table.itertuples()
    )


def near_print(summary: Mapping[str, Any]) -> pd.DataFrame:
    """How many rigs are within each limit of the printed errors, and their claims, tidy."""
    return pd.DataFrame(
        {
            **{key: row[key] for key in ("limit", "holds", "rigs", "share", "low", "high")},
            **row["claims"],
            "source": summary["source"],
        }
        for row in summary["near_print"]
    )


def near_print_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table of the limits as a page, with claims on the reservoir and on loops."""
    return pd.DataFrame(
        {
            "Deviation allowed": row.limit,
            "Met on": f"{row.holds} of {row.rigs}",
            "Share, 95 % interval": _share(row, 1),
            "Of these with B1": row.B1,
            "With C8a": row.C8a,
            "With C18a": row.C18a,
            "With C18b": row.C18b,
        }
        for row in table.itertuples()
    )


def sensitivity(report: Mapping[str, Any]) -> pd.DataFrame:
    """Errors of the models with one parameter changed, relative to the fitted rig's, tidy.

    Raises
    ------
    FprcError
        The fitted rig itself cannot be simulated.
    """
    fitted = next(cell["errors"] for cell in report["cells"] if cell["path"] is None)
    if fitted is None:
        raise FprcError("the fitted rig itself cannot be simulated; correct the section rig")
    return pd.DataFrame(
        {
            "parameter": cell["path"],
            "share_of_range": cell["share"],
            **dict(zip(("trained_on", "model", "phase"), key.split("/"), strict=True)),
            "rmse_kpa": value,
            "change": value / fitted[key] - 1.0,
            "source": report["source"],
        }
        for cell in report["cells"]
        if cell["path"] is not None and cell["errors"] is not None
        for key, value in cell["errors"].items()
    )


def sensitivity_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the change of each error over a parameter's range, strongest parameter first."""
    numbers = {"sweep": "II", "complex": "III"}
    short = {"train": "training", "test": "test"}
    lows_and_highs = table.groupby(["parameter", "trained_on", "model", "phase"], sort=False)[
        "change"
    ].agg(["min", "max"])
    strongest = lows_and_highs.abs().max(axis=1).groupby("parameter").max()
    page = []
    for parameter in strongest.sort_values(ascending=False).index:
        row = {"Parameter": parameter}
        for (trained_on, model, phase), change in lows_and_highs.loc[parameter].iterrows():
            name = f"{numbers[trained_on]} {title_of(model)} {short[phase]}"
            row[name] = f"{100 * change['min']:+.0f} to {100 * change['max']:+.0f} %"
        page.append(row)
    return pd.DataFrame(page)


def targets(
    replicates: Mapping[str, Sequence[Mapping[str, Any]]],
    controls: Mapping[str, Sequence[Mapping[str, Any]]],
    published: Mapping[str, Any],
) -> pd.DataFrame:
    """Tables II to IV over seeds for both targets of the models, tidy.

    Parameters
    ----------
    replicates, controls : Mapping
        Reports of the further seeds by target: command, measured.
    """
    parts = []
    for target, reports in replicates.items():
        table = all_over_seeds(reports, controls[target], published)
        parts.append(table[table["controller"] != "pd"].assign(target=target))
    columns = ["target", "table", "what", "unit", "mean", "low", "high", "published", "source"]
    return pd.concat(parts, ignore_index=True)[columns]


def targets_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the results of both targets and the paper's as a page."""
    page = []
    for (number, what, unit), rows in table.groupby(["table", "what", "unit"], sort=False):
        means = {row.target: format_mean(row._asdict(), "mean") for row in rows.itertuples()}
        page.append(
            {
                "Table": number,
                "RMSE": f"{what} [{unit}]",
                "Target command": means["command"],
                "Target measured": means["measured"],
                "Paper": spread(rows["published"].iloc[0], None),
            }
        )
    return pd.DataFrame(page)
