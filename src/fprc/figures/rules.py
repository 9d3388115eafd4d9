"""The rules of the workflow, and what each needs, as a picture."""

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from functools import cache

import numpy as np
from matplotlib.axes import Axes

Graph = dict[str, frozenset[str]]
#: Rules that need the same and are needed by the same.
Node = tuple[str, ...]


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

    columns: dict[int, list[Node]] = defaultdict(list)
    for node in nodes:
        columns[depth(node)].append(node)
    height = {node: label_of(node).count("\n") + 2 for node in nodes}
    y: dict[Node, float] = {}
    for column in sorted(columns):
        # near what a node needs, so that few lines cross
        columns[column].sort(key=lambda node: float(np.mean([y[n] for n in nodes[node]] or [0])))
        below = -sum(height[node] for node in columns[column]) / 2.0
        for node in columns[column]:
            y[node] = below + height[node] / 2.0
            below += height[node]
    for node, needs in nodes.items():
        for need in needs:
            ax.plot(
                [depth(need), depth(node)], [y[need], y[node]], color="#b0b0b0", lw=0.5, zorder=1
            )
    for node in nodes:
        ax.text(
            depth(node), y[node], label_of(node), ha="center", va="center", fontsize=6.0, zorder=2,
            bbox={"boxstyle": "round,pad=0.25", "facecolor": "white", "edgecolor": "#707070",
                  "linewidth": 0.5},
        )  # fmt: skip
    ax.set_xlim(-0.5, max(columns) + 0.5)
    most = max(abs(value) + height[node] / 2.0 for node, value in y.items())
    ax.set_ylim(most, -most)
    ax.axis("off")
