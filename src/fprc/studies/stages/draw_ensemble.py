"""Draw the claims on sets of rigs."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from fprc.artifacts import read_json
from fprc.figures import style
from fprc.studies.families.figures import plot_correlations, plot_shares_of_rigs

#: Number of parameters that are drawn, those with the strongest correlations.
_PARAMETERS = 14


def draw_ensemble(summary: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Draw shares of rigs, and the strongest correlations with the parameters."""
    report = read_json(summary)
    table = pd.DataFrame(report["claims"])
    limit = table["least_significant"].iloc[0]
    grid = pd.DataFrame(
        {row["id"]: pd.Series(row["correlations"], dtype=float) for row in report["claims"]},
        index=report["parameters"],
    )
    strongest = grid.abs().max(axis=1).sort_values(ascending=False).index[:_PARAMETERS]
    grid = grid.loc[strongest].rename(index=_short)
    fig, axes = style.figure(2, 1, style.PAGE_IN, 6.0, height_ratios=(len(table), len(grid)))
    plot_shares_of_rigs(table, axes[0])
    image = plot_correlations(grid, limit, axes[1])
    bar = fig.colorbar(image, ax=axes[1], location="bottom", pad=0.02, aspect=40, extend="both")
    bar.set_label(f"Rank correlation (chance: {limit:.2f})")
    bar.outline.set_visible(False)
    rigs, beyond = report["rigs"] - report["failed"], int((grid.abs() > limit).sum().sum())
    style.letter(axes[0], f"(a) Claims on {rigs} rigs")
    found = f"{beyond} (x)" if beyond else "none"
    style.letter(axes[1], f"(b) Beyond chance: {found}")
    return style.save(fig, report, pdf, png)


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
