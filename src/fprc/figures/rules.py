"""The rules of the workflow, and what each needs, as a picture."""

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from functools import cache
from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path

_TYPE_PT, _PAD = 6.0, 0.25

Graph = dict[str, frozenset[str]]
#: Rules that need the same and are needed by the same.
Node = tuple[str, ...]
#: A node and a column: its own, or a later one that a line from it passes.
Place = tuple[Node, int]


def read_graph(dot: str) -> Graph:
    """Return what each rule needs directly, from the output of ``snakemake --rulegraph dot``."""
    names = dict(re.findall(r'(\d+)\[label = "(\w+)', dot))
    needs: dict[str, set[str]] = defaultdict(set)
    for source, target in re.findall(r"(\d+) -> (\d+)", dot):
        needs[names[target]].add(names[source])
    return {name: frozenset(needs[name]) for name in names.values()}


def reduced(graph: Mapping[str, frozenset[str]]) -> Graph:
    """Leave out each need that follows from another one."""

    @cache
    def reach(name: str) -> frozenset[str]:
        return graph[name].union(*map(reach, graph[name]))

    return {name: needs.difference(*map(reach, needs)) for name, needs in graph.items()}


def merged(graph: Mapping[str, frozenset[str]]) -> dict[Node, frozenset[Node]]:
    """Return the graph with rules of the same needs and the same uses as one node."""
    uses = {
        name: frozenset(user for user, needs in graph.items() if name in needs) for name in graph
    }
    alike: dict[tuple[frozenset[str], frozenset[str]], list[str]] = defaultdict(list)
    for name in graph:
        alike[graph[name], uses[name]].append(name)
    node_of = {name: tuple(names) for names in alike.values() for name in names}
    return {node: frozenset(node_of[need] for need in graph[node[0]]) for node in node_of.values()}


def label_of(rules: Iterable[str]) -> str:
    """Return the names of a node's rules, the figures as one."""
    figures = [name for name in rules if re.fullmatch(r"draw_fig\d+", name)]
    others = [name for name in rules if name not in figures]
    numbers = ", ".join(name.removeprefix("draw_fig") for name in figures)
    return "\n".join([*others, f"draw_fig {numbers}"] if figures else others)


def plot_rules(graph: Mapping[str, frozenset[str]], ax: Axes) -> None:
    """Draw the reduced graph, from what needs nothing (left) to what nothing needs (right).

    The target ``all`` and the report, which shows every result, are left out.
    """
    shown = {name: needs for name, needs in graph.items() if name not in ("all", "report_page")}
    nodes = merged(reduced(shown))

    @cache
    def depth(node: Node) -> int:
        return 1 + max(map(depth, nodes[node]), default=-1)

    # a line that passes a column gets a place between the boxes there
    before: dict[Place, list[Place]] = {(node, depth(node)): [] for node in nodes}
    for node, needs in nodes.items():
        for need in sorted(needs):
            for column in range(depth(need) + 1, depth(node) + 1):
                place = (need if column < depth(node) else node, column)
                comes_from = before.setdefault(place, [])
                if (need, column - 1) not in comes_from:
                    comes_from.append((need, column - 1))
    columns: dict[int, list[Place]] = defaultdict(list)
    for place in before:
        columns[place[1]].append(place)
    height = {
        (node, column): label_of(node).count("\n") + 2.0 if column == depth(node) else 1.0
        for node, column in before
    }
    y: dict[Place, float] = {}
    for column in sorted(columns):
        # near what a node needs, so that few lines cross
        columns[column].sort(
            key=lambda place: float(np.mean([y[each] for each in before[place]] or [0.0]))
        )
        below = -sum(height[place] for place in columns[column]) / 2.0
        for place in columns[column]:
            y[place] = below + height[place] / 2.0
            below += height[place]
    ax.set_xlim(-0.5, max(columns) + 0.5)
    most = max(abs(value) + height[place] / 2.0 for place, value in y.items())
    ax.set_ylim(most, -most)
    ax.axis("off")
    figure = cast(Figure, ax.get_figure(root=True))
    figure.draw_without_rendering()  # the layout decides how wide a box is in columns
    pad_px = _PAD * _TYPE_PT * figure.dpi / 72.0
    widest = dict.fromkeys(columns, 0.0)
    for node in nodes:
        text = ax.text(
            depth(node), y[node, depth(node)], label_of(node), ha="center", va="center",
            fontsize=_TYPE_PT, zorder=2,
            bbox={"boxstyle": f"round,pad={_PAD}", "facecolor": "white", "edgecolor": "#707070",
                  "linewidth": 0.5},
        )  # fmt: skip
        box = text.get_window_extent().padded(pad_px).transformed(ax.transData.inverted())
        widest[depth(node)] = max(widest[depth(node)], box.width / 2.0)
    for place, comes_from in before.items():
        for each in comes_from:
            # level within the columns, so that it crosses no box, and curved between them
            (start, end), (left, right) = (y[each], y[place]), (each[1], place[1])
            leaves, enters = left + widest[left], right - widest[right]
            middle = (leaves + enters) / 2.0
            points = [(left, start), (leaves, start), (middle, start), (middle, end), (enters, end)]
            # a box hides the line's end; a line that goes on is drawn to the column's far side
            points.append((right + (widest[right] if depth(place[0]) < right else 0.0), end))
            codes = [Path.MOVETO, Path.LINETO, *[Path.CURVE4] * 3, Path.LINETO]
            line = PathPatch(Path(points, codes), fill=False, ec="#b0b0b0", lw=0.5, zorder=1)
            ax.add_patch(line)
