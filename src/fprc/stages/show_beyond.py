"""Tables, figures and page of the comparison beyond the paper."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.artifacts import read_json, write_csv, write_json
from fprc.claims.advice import advice
from fprc.claims.beyond import judge_world
from fprc.competitors import COMPETITORS
from fprc.figures import beyond as figures
from fprc.figures import style
from fprc.tables import beyond as tables

TITLES = {name: entry.title for name, entry in COMPETITORS.items()}


def tabulate_beyond(
    worlds: Sequence[str],
    capacity: str,
    training: str,
    steps: str,
    verdicts: str,
    models: str,
    claims: str,
    tracking: str,
    offsets: str,
    capacities: str,
    lengths: str,
) -> None:
    """Judge B1-B8 in every world, and write the tables.

    Parameters
    ----------
    worlds : sequence of str
        Reports of the worlds; the first one's rig is that of ``training`` and ``steps``.
    capacity : str
        Capacities in each world with one rig.
    verdicts : str
        Outcome: five sentences, and the rows of ``judge_world`` for each world.
    """
    found = _joined(worlds, capacity, training, steps)
    ledgers = [judge_world(world, TITLES) for world in found]
    write_json(
        verdicts,
        {"source": "sim", "advice": advice(found, ledgers, TITLES), "ledgers": ledgers},
    )
    by_model = tables.models(found)
    for path, table in {
        models: by_model,
        claims: tables.claims(ledgers),
        tracking: tables.errors_and_tracking(by_model),
        offsets: tables.offsets(found),
        capacities: tables.capacity(found),
        lengths: tables.lengths(found),
    }.items():
        write_csv(path, table)


def _joined(
    worlds: Sequence[str], capacity: str, training: str, steps: str
) -> list[dict[str, Any]]:
    """Return the worlds with what was measured beside their models."""
    found = [dict(read_json(path)) for path in worlds]
    by_world = read_json(capacity)["worlds"]
    for world in found:
        world["capacity"] = by_world.get(world["name"])
    found[0] |= {
        "training_length": read_json(training)["training_length"],
        "step_us": read_json(steps)["step_us"],
    }
    return found


def draw_pairs(claims: str, pdf: str, png: str, *, worlds: Mapping[str, str]) -> Mapping[str, Any]:
    """Draw the ratio of the errors of each pair in each world.

    Parameters
    ----------
    worlds : Mapping
        Titles of the worlds by name.
    """
    fig, axes = style.figure(1, 1, style.PAGE_IN, 4.6)
    figures.plot_pairs(pd.read_csv(claims), worlds, axes)
    style.share_legend(fig, axes)
    return style.save(fig, _SIMULATED, pdf, png)


def draw_tracking(tracking: str, pdf: str, png: str, *, world: str) -> Mapping[str, Any]:
    """Draw tracking over the forward test error, without and with feedback."""
    table = _of(tracking, world)
    fig, axes = style.figure(2, 1, style.PAGE_IN, 6.0)
    for ax, (loop, words) in zip(axes, _LOOPS.items(), strict=True):
        own = table[table["loop"] == loop]
        figures.plot_errors_and_tracking(own, TITLES, ax)
        found = "".join(f"; rank correlation {value:.2f}" for value in own["rank_correlation"][:1])
        style.letter(ax, words + found)
    return style.save(fig, _SIMULATED, pdf, png)


def draw_offsets(offsets: str, pdf: str, png: str, *, world: str) -> Mapping[str, Any]:
    """Draw the forward test error over the offset of P_o."""
    fig, axes = style.figure(1, 1, style.COLUMN_IN, 3.0)
    figures.plot_offsets(_of(offsets, world), TITLES, axes)
    style.share_legend(fig, axes)
    return style.save(fig, _SIMULATED, pdf, png)


def draw_capacities(capacities: str, pdf: str, png: str, *, world: str) -> Mapping[str, Any]:
    """Draw the capacities of each set of states."""
    fig, axes = style.figure(1, 1, style.COLUMN_IN, 3.0)
    figures.plot_capacities(_of(capacities, world), axes)
    style.share_legend(fig, axes)
    return style.save(fig, _SIMULATED, pdf, png)


_SIMULATED: dict[str, Any] = {"source": "sim", "seeds": []}
_LOOPS = {"open_loop": "(a) Open loop", "closed_loop": "(b) Closed loop"}


def _of(path: str, world: str) -> pd.DataFrame:
    table = pd.read_csv(path)
    return table[table["world"] == world]
