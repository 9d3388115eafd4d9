import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.rig.valve import mass_flow

pressures = st.floats(50.0, 800.0)
critical_ratios = st.floats(0.2, 0.5)


@given(pressures, pressures, critical_ratios)
def test_flow_reverses_when_the_pressures_swap(p1, p2, b):
    assert mass_flow(4.0, p1, p2, b) == -mass_flow(4.0, p2, p1, b)


@pytest.mark.parametrize("b", [0.2, 0.3, 0.5])
def test_slope_stays_finite_where_the_pressures_meet(b):
    gaps_kpa = np.array([1e-9, 1e-6, 1e-3, 1.0])
    slopes = [mass_flow(4.0, 600.0, 600.0 - gap, b) / gap for gap in gaps_kpa]
    np.testing.assert_allclose(slopes, slopes[-1], rtol=1e-4)
    # the ellipse alone has an infinite slope there: sqrt(gap)
    assert mass_flow(4.0, 600.0, 600.0 - 1e-9, b) < 1e-3 * 4.0 * 600.0 * np.sqrt(1e-9 / 600.0)
