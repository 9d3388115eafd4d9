"""Tables, figures and page of the comparison beyond the paper."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from fprc.artifacts import read_json, write_csv, write_json, write_text
from fprc.figures import style
from fprc.studies.beyond import figures as figures
from fprc.studies.beyond import tables as tables
from fprc.studies.beyond.claims import beside_b1, judge_family
from fprc.studies.beyond.measurements import family_of
from fprc.studies.beyond.verdicts import claims as claims_table


def tabulate_beyond(
    families: Sequence[str],
    capacity: str,
    training: str,
    steps: str,
    over_settings: str,
    verdicts: str,
    pages: Sequence[str],
    *,
    family: str,
    **csv: str,
) -> None:
    """Judge B1-B8 in every family, and write the tables.

    Parameters
    ----------
    families : sequence of str
        Reports of the families; the first one's rig is that of ``training`` and ``steps``.
    capacity : str
        Capacities in each family with one rig.
    over_settings : str
        Errors over epsilon and n_c.
    verdicts : str
        Outcome: what each family is, and the rows of ``judge_family`` for each.
    pages : sequence of str
        Tables in Markdown, named after ``tables.pages``.
    family : str
        Family whose models, offsets, capacities and lengths the pages show.
    **csv : str
        Tables by name: ``models``, ``claims``, ``tracking``, ``offsets``, ``capacities``,
        ``lengths``, ``settings``.
    """
    found = [family_of(read_json(path)) for path in families]
    capacities = read_json(capacity)["cells"]
    for judged in found:
        judged["capacity"] = [row for row in capacities if row["family"] == judged["name"]]
    found[0]["training_length"] = read_json(training)["cells"]
    found[0]["step_us"] = read_json(steps)["cells"][0]["step_us"]
    ledgers = list(map(judge_family, found))
    outcome = {
        "source": "sim",
        "worlds": tables.families_page(found).to_dict("records"),
        "ledgers": ledgers,
        "beside": list(map(beside_b1, found)),
    }
    by_model = tables.models(found)
    made = {
        "models": by_model,
        "claims": claims_table(ledgers),
        "tracking": tables.errors_and_tracking(by_model),
        "offsets": tables.offsets(found),
        "capacities": tables.capacity(found),
        "lengths": tables.lengths(found),
        "settings": tables.over_settings(read_json(over_settings)["cells"]),
    }
    write_json(verdicts, outcome)
    for name, table in made.items():
        write_csv(csv[name], table)
    texts = tables.pages(outcome, made, family)
    for path in pages:
        write_text(path, texts[Path(path).stem])


def draw_pairs(claims: str, pdf: str, png: str, *, families: Sequence[str]) -> Mapping[str, Any]:
    """Draw the ratio of the errors of each pair in each family, in the order of ``families``."""
    fig, axes = style.figure(1, 1, style.PAGE_IN, 4.6)
    figures.plot_pairs(pd.read_csv(claims), families, axes)
    style.share_legend(fig, axes)
    return style.save(fig, _SIMULATED, pdf, png)


def draw_tracking(tracking: str, pdf: str, png: str, *, family: str) -> Mapping[str, Any]:
    """Draw tracking over the forward test error, without and with feedback."""
    table = _of(tracking, family)
    fig, axes = style.figure(2, 1, style.COLUMN_IN, 4.4, sharex=True)
    for ax, (loop, words) in zip(axes, _LOOPS.items(), strict=True):
        of_loop = table[table["loop"] == loop]
        figures.plot_errors_and_tracking(of_loop, ax)
        ax.label_outer()
        found = "".join(
            f"; rank correlation {value:.2f}" for value in of_loop["rank_correlation"][:1]
        )
        style.letter(ax, words + found)
    return style.save(fig, _SIMULATED, pdf, png)


def draw_offsets(offsets: str, pdf: str, png: str, *, family: str) -> Mapping[str, Any]:
    """Draw the forward test error and the tracking errors over the offset of P_o."""
    table = _of(offsets, family)
    fig, axes = style.figure(1, 3, style.PAGE_IN, 2.6, sharex=True)
    for ax, measure in zip(axes, ("forward", *_LOOPS), strict=True):
        figures.plot_offsets(table, measure, ax)
    style.share_legend(fig, axes[0])
    return style.save(fig, _SIMULATED, pdf, png)


def draw_capacities(capacities: str, pdf: str, png: str, *, family: str) -> Mapping[str, Any]:
    """Draw the capacities of each set of states."""
    fig, axes = style.figure(1, 1, style.COLUMN_IN, 3.0)
    figures.plot_capacities(_of(capacities, family), axes)
    style.share_legend(fig, axes)
    return style.save(fig, _SIMULATED, pdf, png)


def draw_settings(settings: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Draw FPRC's error over that of FPRC on low-passed theta_d, over epsilon and over n_c."""
    table = pd.read_csv(settings)
    fig, axes = style.figure(1, 2, style.PAGE_IN, 2.4, sharey=True)
    for ax, (_, of_setting) in zip(axes, table.groupby("setting", sort=False), strict=True):
        figures.plot_settings(of_setting, ax)
        ax.label_outer()
    axes[0].set_ylim(table["low"].min() / 1.05, table["high"].max() * 1.05)
    style.share_legend(fig, axes[0])
    return style.save(fig, _SIMULATED, pdf, png)


_SIMULATED: dict[str, Any] = {"source": "sim", "seeds": []}
_LOOPS = {"open_loop": "(a) Open loop", "closed_loop": "(b) Closed loop"}


def _of(path: str, family: str) -> pd.DataFrame:
    table = pd.read_csv(path)
    return table[table["world"] == family]
