from itertools import combinations, product

import matplotlib.pyplot as plt
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.path import Path

from fprc.figures.rules import label_of, merged, plot_rules, read_graph, reduced

NAMES = "abcdef"
ARROWS = list(combinations(NAMES, 2))


@st.composite
def graphs(draw):
    """Each rule may need those that come later in the alphabet."""
    chosen = draw(st.sets(st.sampled_from(ARROWS)))
    return {name: frozenset(b for a, b in chosen if a == name) for name in NAMES}


def reached(graph):
    """Every pair of a rule and what it needs, directly or not, by brute force."""
    pairs = {(a, b) for a in graph for b in graph[a]}
    while more := {(a, d) for (a, b), (c, d) in product(pairs, pairs) if b == c} - pairs:
        pairs |= more
    return pairs


@given(graphs())
def test_reduced_graph_reaches_the_same_by_as_few_needs_as_possible(graph):
    fewer = reduced(graph)
    assert reached(fewer) == reached(graph)
    for name, needs in fewer.items():
        for need in needs:
            assert reached(fewer | {name: needs - {need}}) != reached(graph)


@given(graphs())
def test_merged_graph_has_every_rule_once_and_its_needs(graph):
    nodes = merged(graph)
    assert sorted(name for node in nodes for name in node) == list(NAMES)
    for node, needs in nodes.items():
        for name in node:
            assert graph[name] == {need for other in needs for need in other}


def test_graph_of_snakemake_is_read():
    dot = """digraph snakemake_dag {
    0[label = "all", color = "0.1 0.6 0.85", style="rounded"];
    1[label = "judge", color = "0.2 0.6 0.85", style="rounded"];
    2[label = "record", color = "0.3 0.6 0.85", style="rounded"];
    1 -> 0
    2 -> 1
}"""
    assert read_graph(dot) == {"all": {"judge"}, "judge": {"record"}, "record": frozenset()}


def test_figures_share_a_line():
    assert label_of(["seeds", "draw_fig4", "draw_fig5"]) == "seeds\ndraw_fig 4, 5"


def test_line_crosses_no_box_but_those_that_it_joins():
    wide = [f"rule_with_a_long_name_{n}" for n in range(8)]
    graph = {"hub": frozenset(), "early": frozenset()} | dict.fromkeys(wide, frozenset({"hub"}))
    graph |= {f"use_{n}": frozenset({name}) for n, name in enumerate(wide)}
    graph |= {"late": frozenset({wide[0], wide[7], "early"}), "last": frozenset({"use_0", "use_7"})}
    fig, ax = plt.subplots(figsize=(7.0, 4.2), layout="constrained")
    try:
        plot_rules(graph, ax)
        fig.draw_without_rendering()
        boxes = [text.get_window_extent() for text in ax.texts]
        assert len(ax.patches) >= sum(map(len, graph.values()))
        for line in ax.patches:
            (curve,) = line.get_path().to_polygons(ax.transData, closed_only=False)
            points = Path(curve).interpolated(50).vertices
            inside = [box for box in boxes if any(box.contains(*point) for point in points)]
            assert all(any(box.contains(*end) for end in points[[0, -1]]) for box in inside)
    finally:
        plt.close(fig)
