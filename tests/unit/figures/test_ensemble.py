import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest

from fprc.figures import style
from fprc.figures.ensemble import plot_front

pytestmark = pytest.mark.slow

TABLE = pd.DataFrame(
    [
        ("one", 40, "front", 9.0, 30.0), ("one", 40, "front", 10.0, 12.0),
        ("one", 40, "end", 10.5, 14.0), ("two", 50, "end", 8.0, 41.0),
    ],
    columns=["search", "rigs", "kind", "tables_percent", "claims_loss"],
)  # fmt: skip


@pytest.fixture
def ax():
    _, ax = style.figure(1, 1, style.COLUMN_IN, 2.6)
    yield plot_front(TABLE, ax)
    plt.close("all")


def test_front_is_a_staircase_through_its_rigs_and_ends_are_apart(ax):
    lines = [np.column_stack(line.get_data()).tolist() for line in ax.get_lines()]
    assert [[9.0, 30.0], [10.0, 30.0], [10.0, 12.0]] in [
        line.get_path().vertices.tolist() for line in ax.get_lines()
    ]
    assert [[10.5, 14.0]] in lines
    assert [[8.0, 41.0]] in lines


def test_legend_has_a_line_only_for_a_search_with_a_front(ax):
    legend = ax.get_legend()
    drawn = {
        text.get_text(): handle.get_linestyle()
        for text, handle in zip(legend.get_texts(), legend.get_lines(), strict=True)
    }
    assert drawn == {"one, 40 rigs": "-", "two": "None"}


def test_claims_are_on_a_linear_axis_from_zero(ax):
    assert ax.get_yscale() == "linear"
    assert ax.get_ylim()[0] == 0.0
    assert ax.get_ylim()[1] > 41.0
