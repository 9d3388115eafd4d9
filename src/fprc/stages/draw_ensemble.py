"""Draw the results of sets of rigs, and of the searches."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from fprc.artifacts import read_json, write_csv
from fprc.calibration.objective import CLAIMS
from fprc.figures import style
from fprc.figures.ensemble import plot_correlations, plot_front, plot_shares_of_rigs


def draw_ensemble(summary: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Draw shares of rigs, and correlations with the parameters."""
    report = read_json(summary)
    table = pd.DataFrame(report["claims"])
    paths = report["parameters"]
    grid = pd.DataFrame(
        [
            [row["correlations"].get(path, float("nan")) for path in paths]
            for row in report["claims"]
        ],
        index=table["id"],
        columns=[_short(path) for path in paths],
    )
    fig, axes = style.figure(2, 1, 1.5 * style.COLUMN_IN, 6.4, height_ratios=(2, 3))
    plot_shares_of_rigs(table, axes[0])
    image = plot_correlations(grid, table["least_significant"].iloc[0], axes[1])
    bar = fig.colorbar(image, ax=axes[1], location="right", pad=0.02, aspect=30)
    bar.set_label("Rank correlation")
    bar.outline.set_visible(False)
    rigs = report["rigs"] - report["failed"]
    style.letter(axes[0], f"(a) Claims on {rigs} rigs, 95 % intervals")
    style.letter(axes[1], "(b) Parameters that go with holding; x: beyond chance")
    return style.save(fig, report, pdf, png)


def draw_front(fits: Sequence[str], csv: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Draw fronts between tables and claims, and where the searches ended.

    A search counts if its objective held as many terms as any other's.
    """
    reports = {Path(path).stem: read_json(path) for path in fits}
    most = max(len(report.get("fit", ())) for report in reports.values())
    reports = {name: own for name, own in reports.items() if len(own.get("fit", ())) == most}
    rows = []
    for name, report in reports.items():
        ended = {
            "tables": report["terms"]["tables"],
            "claims": sum(report["terms"][term] for term in CLAIMS),
        }
        of_search = [("front", own) for own in report.get("front", ())] + [("end", ended)]
        rows += [
            {
                "search": name,
                "rigs": report["evaluations"],
                "kind": kind,
                # the objective divides the logarithms by 5 %
                "tables_percent": 5.0 * (own["tables"] / len(report["targets_kpa"])) ** 0.5,
                "claims_loss": own["claims"],
            }
            for kind, own in of_search
        ]
    table = pd.DataFrame(rows)
    write_csv(csv, table)
    fig, axes = style.figure(1, 1, style.COLUMN_IN, 2.6)
    plot_front(table, axes)
    seeds = sorted({seed for report in reports.values() for seed in report["seeds"]})
    return style.save(fig, {"source": "sim", "seeds": seeds}, pdf, png)


def _short(path: str) -> str:
    """Return a parameter's name without its unit, short enough for a small figure."""
    section, name, *index = path.split(".")
    name = name.replace("_per_kpa", "_over_pressure").replace("_ml_per_deg", "_over_angle")
    words = name.split("_")
    units = {"kpa", "deg", "ml", "s", "per", "v", "hz", "rad", "deg3"}
    while words and words[-1] in units:
        words.pop()
    part = "".join(f" {int(number) + 1}" for number in index)
    return f"{section.replace('_', ' ')}: {' '.join(words)}{part}"
