"""Shares of rigs on which claims hold."""

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from fprc.figures.style import MARK_PT, symbols

#: Shape and colour of each set.
_LOOKS = (("o", "black"), ("s", "tab:blue"))


def plot_shares(sets: Sequence[Mapping[str, Any]], ax: Axes) -> None:
    """Draw the share of rigs on which each claim holds, with its interval, a colour per set.

    Parameters
    ----------
    sets : sequence of mapping
        Families of many rigs, see ``fprc.studies.stages.families.compare_families``. Claims are
        drawn from the share of the first family downwards.
    """
    first = sorted(sets[0]["claims"], key=lambda claim: -claim["holds"]["share"])
    rows = np.arange(len(first))
    for k, (family, (marker, color)) in enumerate(zip(sets, _LOOKS, strict=False)):
        held = {claim["id"]: claim["holds"] for claim in family["claims"]}
        share, low, high = (
            np.array([100 * held[claim["id"]][key] for claim in first])
            for key in ("share", "low", "high")
        )
        ax.errorbar(
            share, rows + 0.26 * (k - 0.5), xerr=[share - low, high - share], fmt=marker,
            color=color, markersize=3, capsize=0, linewidth=0.8, label=family["title"],
        )  # fmt: skip
    labels = [_label(claim) for claim in first]
    ax.set(xlim=(-3, 103), xlabel="Share of rigs, 95 % interval [%]", yticks=rows)
    ax.set_yticklabels(labels, fontsize=MARK_PT, linespacing=0.95)
    ax.set_ylim(len(first) - 0.5, -0.5)
    ax.grid(axis="y", color="0.9", linewidth=0.5)


def _label(claim: Mapping[str, Any]) -> str:
    """Return id and text of a claim in two lines at most."""
    text = f"{claim['id']}: {claim['claim'].replace('+-', '±')}"
    lines = textwrap.wrap(text, 64, max_lines=2, placeholder=" ...", break_on_hyphens=False)
    return "\n".join(map(symbols, lines))
