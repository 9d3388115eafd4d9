"""Judge the claims on families of rigs, and show the families side by side."""

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from scipy.stats import binomtest

from fprc.artifacts import read_json, write_json
from fprc.claims.finding import REPRODUCED, Results
from fprc.claims.ledger import Fit, judge_claims
from fprc.claims.paper import ASSUMED, CLAIMS, TIMED
from fprc.errors import FprcError
from fprc.figures import style
from fprc.paper import SOURCES
from fprc.signals import LEVEL
from fprc.studies.families import tables
from fprc.tables.text import write_table
from fprc.yaml_file import read_yaml

#: Claims that Tables II to IV, weights and loops decide; the others need grids or times, or are
#: assumed.
JUDGED_BY_RIG = [claim for claim in CLAIMS if claim.over == "seeds" and claim.kind != ASSUMED]

#: Shape and colour of each set.
_LOOKS = (("o", "black"), ("s", "tab:blue"))


def share_of(held: np.ndarray) -> dict[str, Any]:
    """Return on how many rigs something holds, their number, the share and its Wilson interval."""
    holds = int(held.sum())
    interval = binomtest(holds, held.size).proportion_ci(LEVEL, method="wilson")
    return {
        "holds": holds,
        "rigs": held.size,
        "share": holds / held.size,
        "low": float(interval.low),
        "high": float(interval.high),
    }


def compare_families(
    published: str,
    models: Sequence[str],
    grids: Sequence[str],
    controls: Sequence[str],
    summary: str,
    *,
    named: Mapping[str, Fit],
    sets: Mapping[str, Mapping[str, Any]],
    **judged: str,
) -> None:
    """Judge the claims on every family.

    Parameters
    ----------
    models, grids, controls : sequence of str
        Results over seeds, rig by rig; every named rig has the same number of them.
    named, sets : Mapping
        Families of one rig: what it was fitted to, see ``judge_claims``. Families of many rigs: the
        ``terms``, the ``title`` and the ``description``.
    **judged
        Result of ``judge_tables`` of each set.

    Writes a list of families, each with ``name``, ``title`` and ``description``; ``errors``, a row
    per printed number with its ``published``, ``middle``, ``low`` and ``high``; ``sums``, the same
    three of each of ``tables.SUMS``; and ``claims``, with ``verdict``, or with ``holds``, see
    ``share_of``.

    Raises
    ------
    FprcError
        No rig of a set could be judged.
    """
    printed = read_yaml(published)
    families = []
    for k, name in enumerate(named):
        of_models, of_grids, of_control = (
            [read_json(path) for path in np.array_split(paths, len(named))[k]]
            for paths in (models, grids, controls)
        )
        rig, words = Results(of_models, of_grids, of_control, {}, {}), f"Rig {name}"
        of_rig = _judged(printed, named[name], [rig], words, words, one_rig=True)
        families.append({"name": name, **of_rig})
    for name, described in sets.items():
        rigs = read_json(judged[name])["cells"]
        good = [
            Results([rig["compared"]], [], [rig["measured"]], {}, {})
            for rig in rigs
            if "failed" not in rig
        ]
        if not good:
            raise FprcError(
                f"{name}: none of the {len(rigs)} rigs could be judged; the first: "
                f"{rigs[0]['failed']}"
            )
        words = f"{len(good)} {described['description']}"
        of_set = _judged(printed, {"to": described["terms"]}, good, described["title"], words)
        families.append({"name": name, **of_set})
    write_json(summary, {"source": "sim", "families": families})


def _judged(
    printed: Mapping[str, Any],
    fitted: Fit,
    rigs: Sequence[Results],
    title: str,
    description: str,
    *,
    one_rig: bool = False,
) -> dict[str, Any]:
    """Judge a family: one rig with all its seeds, or many rigs with one recording each."""
    claims = [claim for claim in CLAIMS if claim.kind != TIMED] if one_rig else JUDGED_BY_RIG
    ledgers = [judge_claims(rig, printed, fitted, claims) for rig in rigs]
    units = [tables.rig_errors(rig.replicates, rig.controls, printed) for rig in rigs]
    sums = pd.DataFrame([tables.sums_of(unit) for unit in units])
    held = pd.DataFrame({row["id"]: row["verdict"] == REPRODUCED for row in x} for x in ledgers)
    return {
        "title": title,
        "description": description,
        "errors": _rows(units),
        "sums": {key: _quantiles(sums[key]) for key in sums},
        "claims": [
            {
                **{key: row[key] for key in ("id", "claim", "rig")},
                "verdict": row["verdict"] if one_rig else None,
                "holds": None if one_rig else share_of(held[row["id"]].to_numpy()),
            }
            for row in ledgers[0]
        ],
    }


def tabulate_families(summary: str, *, table: str, **files: str) -> None:
    """Write one of the tables of the families: errors or claims."""
    page, note = tables.TABLES[table](read_json(summary)["families"])
    write_table(page, page, f"{note}\nData: {SOURCES['sim']}.", **files)


def draw_claims(summary: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Draw on how many rigs of each set the claims hold."""
    report = read_json(summary)
    sets = [family for family in report["families"] if family["claims"][0]["holds"]]
    fig, ax = style.figure(1, 1, style.PAGE_IN, 7.0)
    # long labels are wider at the resolution of the file than at that of the layout
    fig.set_layout_engine("constrained", w_pad=0.15)
    plot_shares(sets, ax)
    style.legend_above(ax)
    return style.save(fig, report | {"seeds": []}, pdf, png)


def plot_shares(sets: Sequence[Mapping[str, Any]], ax: Axes) -> None:
    """Draw the share of rigs on which each claim holds, with its interval, a colour per set.

    Parameters
    ----------
    sets : sequence of mapping
        Families of many rigs, see ``compare_families``. Claims are
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
    ax.set_yticklabels(labels, fontsize=style.MARK_PT, linespacing=0.95)
    ax.set_ylim(len(first) - 0.5, -0.5)
    ax.grid(axis="y", color="0.9", linewidth=0.5)


def _label(claim: Mapping[str, Any]) -> str:
    """Return id and text of a claim in two lines at most."""
    text = f"{claim['id']}: {claim['claim'].replace('+-', '±')}"
    lines = textwrap.wrap(text, 64, max_lines=2, placeholder=" ...", break_on_hyphens=False)
    return "\n".join(map(style.symbols, lines))


def _rows(units: Sequence[pd.DataFrame]) -> list[dict[str, Any]]:
    """Return the printed numbers with middle and range: over seeds of one rig, or over rigs."""
    rows = units[0][["number", "published"]].to_dict("records")
    if len(units) == 1:
        ends = units[0][["mean", "low", "high"]].to_numpy().tolist()
    else:
        means = np.array([unit["mean"] for unit in units])
        ends = [_quantiles(column) for column in means.T]
    names = ("middle", "low", "high")
    return [row | dict(zip(names, end, strict=True)) for row, end in zip(rows, ends, strict=True)]


def _quantiles(values: Any) -> list[float]:
    return [float(value) for value in np.quantile(values, (0.5, 0.025, 0.975))]
