"""Figures of families with many models, and with almost none."""

import pytest
from matplotlib.colors import to_hex

from fprc.studies.stages import beyond as figures


@pytest.fixture(scope="module")
def families(make_family):
    few = ("fprc", "fuzzy_linear", "fprc_lowpass")
    return {"dry": make_family(spread=0.02), "sparse": make_family("sparse", units=3, models=few)}


@pytest.mark.parametrize("family", ["dry", "sparse"])
def test_pairs_have_a_row_each_and_the_band_of_equivalence(families, family, axes, judge_claims):
    table = judge_claims(families[family])
    figures.plot_pairs(table, axes)
    assert len(axes.get_yticks()) == len(table.dropna(subset="part"))
    assert axes.get_xscale() == "log"
    ends = axes.patches[0].get_extents().transformed(axes.transData.inverted())
    assert [ends.x0, ends.x1] == pytest.approx([1 / 1.05, 1.05])
    assert 1.0 in axes.get_xticks()


def test_hollow_markers_are_undecided(families, axes, judge_claims):
    table = judge_claims(*families.values())
    figures.plot_pairs(table, axes)
    shown = table.dropna(subset="part")
    hollow = [to_hex(bars[0].get_markerfacecolor()) == "#ffffff" for bars in axes.containers]
    assert hollow == shown["verdict"].isin(["undecided", "not judged"]).tolist()
    assert any(hollow)
    assert not all(hollow)
    centres = [bars[0].get_xdata()[0] for bars in axes.containers]
    assert centres == pytest.approx(shown["mean"].tolist())


def test_family_of_failures_is_drawn_empty(make_family, axes, judge_claims):
    family = make_family(cells=[{"unit": 0, "seed": 1, "failed": "no pressure"}])
    figures.plot_pairs(judge_claims(family), axes)
    assert axes.get_xlabel()
    assert not axes.texts
    assert not axes.containers
