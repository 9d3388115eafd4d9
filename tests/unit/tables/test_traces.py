import base64
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.tables import traces
from fprc.tables.traces import decimate, disturbance_plots, fit_plots, pack, tracking_plots

VALUES = st.floats(-1e6, 1e6)


def decoded(low, high, codes):
    """Values of a packed trace, as the page's script reads them."""
    numbers = np.frombuffer(base64.b64decode(codes), dtype="<u2").astype(float)
    return np.where(numbers == 65535, np.nan, low + numbers * (high - low) / 65534)


@given(st.lists(st.tuples(st.floats(0.0, 10.0), VALUES), min_size=1, max_size=60),
       st.integers(1, 20))  # fmt: skip
def test_decimated_trace_keeps_the_extremes_of_every_stretch(samples, stretches):
    time_s, values = np.array(sorted(samples)).T
    edges_s = np.linspace(0.0, 10.0, stretches + 1)
    kept = decimate(time_s, values, edges_s).reshape(-1, 2)
    assert np.nanmin(kept) == values.min()
    assert np.nanmax(kept) == values.max()
    for number, (ends, low, high) in enumerate(zip(kept, edges_s[:-1], edges_s[1:], strict=True)):
        last = number == stretches - 1
        inside = values[(time_s >= low) & ((time_s < high) | last)]
        if len(inside) == 0:
            assert np.isnan(ends).all()
        else:
            rises = inside[-1] >= inside[0]
            assert list(ends) == sorted([inside.min(), inside.max()], reverse=not rises)


@given(st.lists(VALUES | st.just(np.nan), min_size=1).filter(lambda v: not np.isnan(v).all()))
def test_packed_values_come_back_to_a_65534th_of_their_range(values):
    values = np.array(values)
    low, high, codes = pack(values)
    assert (low, high) == (np.nanmin(values), np.nanmax(values))
    back = decoded(low, high, codes)
    assert np.array_equal(np.isnan(back), np.isnan(values))
    some = ~np.isnan(values)
    assert np.abs(back - values)[some].max() <= 0.51 * (high - low) / 65534 + 1e-9
    assert back[some].min() == low
    assert back[some].max() == pytest.approx(high, rel=1e-12, abs=1e-9)


def log_of(samples, seed, **attributes):
    rng = np.random.default_rng(seed)
    time_s = 0.005 * np.arange(samples)
    names = ("p_target_kpa", "p_ff_kpa", "p_fb_kpa", "theta_deg", "p_i_kpa", "phi_deg", "p_o_kpa")
    channels = {name: rng.normal(size=samples) for name in names}
    reference = 30.0 - 25.0 * np.cos(np.pi * time_s)
    channels |= {"time_s": time_s, "theta_d_deg": reference}
    return SimpleNamespace(channels=channels, attributes=attributes)


def shown(plot, title, number):
    panel = next(panel for panel in plot.panels if panel.title == title)
    trace = panel.traces[number]
    return decoded(trace.low, trace.high, trace.codes)


def test_short_log_keeps_every_peak_of_its_error_in_order():
    logs = {"Training": log_of(400, 1, p_target_unit="bar"), "Test": log_of(300, 2)}
    training, test = fit_plots(logs)
    assert (training.title, training.begin_s, training.end_s) == ("Training", 0.0, 399 * 0.005)
    assert [panel.unit for panel in training.panels] == ["bar", "bar"]
    assert [panel.unit for panel in test.panels] == ["kPa", "kPa"]
    channels = logs["Test"].channels
    error = channels["p_ff_kpa"] - channels["p_target_kpa"]
    assert shown(test, "Error", 0) == pytest.approx(error, abs=1e-3)  # two samples a stretch


def test_long_log_leaves_two_values_of_each_stretch():
    (plot,) = tracking_plots(log_of(9000, 1), log_of(8900, 2))
    assert [len(panel.traces) for panel in plot.panels] == [2, 2, 2, 2]
    values = shown(plot, "FPRC", 1)
    assert len(values) == 2 * traces.STRETCHES
    assert not np.isnan(values).any()
    shorter = shown(plot, "FPRC+PD", 1)
    assert np.isnan(shorter[-2 * 33 :]).all()  # 100 of its 9000 samples are missing at the end
    assert not np.isnan(shorter[: -2 * 34]).any()


def test_errors_of_both_loops_are_the_reference_less_the_angle():
    runs = log_of(300, 1), log_of(300, 2)
    (plot,) = tracking_plots(*runs)
    for number, run in enumerate(runs):
        error = run.channels["theta_d_deg"] - run.channels["theta_deg"]
        drawn = shown(plot, "Errors, theta_d - theta", number)
        assert drawn == pytest.approx(error, abs=2e-3)
    assert [trace.name for trace in plot.panels[3].traces] == ["P_ff", "P_fb"]


@pytest.mark.parametrize(("quiet_s", "names"), [(6.0, ["undisturbed cycle", "P_o"]), (1, ["P_o"])])
def test_reservoir_lies_over_its_undisturbed_cycle_if_there_is_one(quiet_s, names):
    (plot,) = disturbance_plots(log_of(2000, 1), quiet_s)
    panel = plot.panels[-1]
    assert (panel.title, panel.unit) == ("Output of the reservoir", "kPa")
    assert [trace.name for trace in panel.traces] == names
