import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.paper import CONTROLLERS, REFERENCES
from fprc.signals import (
    measure_hysteresis,
    measure_pressure_error,
    measure_range,
    measure_runs,
)

RATE_HZ, QUIET_S = 200.0, 12.0
RUNS = [f"{name}/{law}" for name in (*REFERENCES, "disturbance") for law in CONTROLLERS]
TIME_S = 5.0 + np.arange(int(30 * RATE_HZ)) / RATE_HZ
PUSHED = TIME_S >= QUIET_S


def chirp(time_s, swing=27.5):
    """From 0.05 to 0.95 Hz, from 5 to 60 deg."""
    f_hz = 0.05 + 0.45 * (time_s - 5.0) / 30.0
    return 32.5 - swing * np.cos(2 * np.pi * f_hz * (time_s - 5.0))


def sine(lag=0.0, swing=27.5):
    return 32.5 - swing * np.cos(np.pi * TIME_S - lag)


def run(theta_d=None, theta=None, **channels):
    theta_d = chirp(TIME_S) if theta_d is None else theta_d
    return {
        "time_s": TIME_S,
        "theta_d_deg": theta_d,
        "theta_deg": theta_d + 0.0 if theta is None else theta,
        "p_ff_kpa": np.full_like(TIME_S, 200.0),
        "p_fb_kpa": np.full_like(TIME_S, 10.0),
        "p_i_kpa": 7.0 * theta_d,
        "p_o_kpa": 100.0 + 0.5 * theta_d,
        "phi_deg": 0.9 * theta_d,
    } | channels


def measured(**changed):
    """Measure perfect runs, some of which are replaced; "/" is written "__" in their names."""
    runs = {name: run(sine() if "sine" in name else None) for name in RUNS}
    runs |= {name.replace("__", "/"): replaced for name, replaced in changed.items()}
    return measure_runs(runs, UNPUSHED, QUIET_S)


#: The disturbance test without pushes: 2 deg off.
UNPUSHED = run(theta=chirp(TIME_S) - 2.0)


@pytest.fixture(scope="module")
def perfect():
    return measured()


def test_perfect_runs_have_no_error_no_lag_and_no_loop(perfect):
    assert perfect["rmse_deg"] == dict.fromkeys(RUNS, 0.0)
    names = ("largest_error_deg", "lag_ms", "first_third_deg", "last_third_deg")
    assert perfect["sweep"] == dict.fromkeys(names, 0.0)
    for loop in perfect["loops"].values():
        assert loop["width_over_span"] == pytest.approx(0.0, abs=1e-3)


@given(st.lists(st.floats(-50.0, 50.0), min_size=2, max_size=4))
def test_error_of_a_run_is_the_rms_of_its_own_samples(pattern):
    error = np.resize(pattern, TIME_S.size)
    theta_d = chirp(TIME_S)
    found = measured(complex__fprc=run(theta_d, theta_d - error))["rmse_deg"]
    expected = np.linalg.norm(error) / np.sqrt(error.size)
    assert found.pop("complex/fprc") == pytest.approx(expected, abs=1e-9)
    assert set(found.values()) == {0.0}


@pytest.mark.parametrize("reference", REFERENCES)
def test_effort_is_rms_of_feedback_over_rms_of_feedforward(reference):
    alternating = np.resize([3.0, -4.0], TIME_S.size)
    busy = run(p_fb_kpa=alternating, p_ff_kpa=np.resize([30.0, 40.0], TIME_S.size))
    found = measured(**{f"{reference}__fprc_pd": busy})["effort"]
    assert found.pop(reference) == pytest.approx(0.1, rel=1e-12)
    assert list(found.values()) == pytest.approx([0.05] * 3, rel=1e-12)


def grid_values(theta):
    return measured(sweep__fprc_pd=run(theta=theta))["sweep"]


@pytest.mark.parametrize("samples", [-40, -7, -1, 0, 1, 6, 39])
def test_lag_is_the_delay_of_the_angle_in_the_last_ten_seconds(samples):
    theta = chirp(TIME_S - samples / RATE_HZ)
    assert grid_values(theta)["lag_ms"] == pytest.approx(5.0 * samples)
    theta[: -int(10 * RATE_HZ)] = 32.5
    assert grid_values(theta)["lag_ms"] == pytest.approx(5.0 * samples)


def test_error_of_the_sweep_is_split_into_thirds():
    error = np.repeat([1.0, 4.0, 2.0], TIME_S.size // 3) * np.resize([1.0, -1.0], TIME_S.size)
    error[TIME_S.size // 2] = -9.0
    found = grid_values(chirp(TIME_S) - error)
    assert found["first_third_deg"] == pytest.approx(1.0)
    assert found["last_third_deg"] == pytest.approx(2.0)
    assert found["largest_error_deg"] == pytest.approx(9.0)


@pytest.mark.parametrize("name", ["sine_0p5/pd", "sine_0p5/fprc_pd"])
@pytest.mark.parametrize(("lag", "swing"), [(0.5, 27.5), (0.05, 27.5), (0.3, 5.0), (-0.2, 20.0)])
def test_loop_of_a_late_sine_is_as_wide_as_the_sine_of_its_phase(name, lag, swing):
    """An ellipse: at the middle of the reference it is 2 A sin(lag) wide, and spans 2 A."""
    loops = measured(**{name.replace("/", "__"): run(sine(), sine(lag, swing))})["loops"]
    assert loops[name]["width_over_span"] == pytest.approx(abs(np.sin(lag)), rel=5e-3)


def disturbed(**channels):
    return measured(disturbance__fprc_pd=run(**channels))["disturbance"]


@pytest.mark.parametrize(
    ("name", "key", "gain"), [("phi_deg", "bending", 0.9), ("p_o_kpa", "p_o", 0.5)]
)
def test_what_the_pushes_change_is_a_share_of_the_swing_without_them(name, key, gain):
    tone = 4.0 * np.sin(2 * np.pi * 7.0 * TIME_S)
    found = disturbed(**{name: UNPUSHED[name] + tone * PUSHED})
    swing = gain * np.ptp(chirp(TIME_S))
    assert found.pop(key) == pytest.approx(4.0 / 2**0.5 / swing, rel=1e-3)
    del found["error_ratio"]
    assert list(found.values()) == [0.0]


def test_tracking_error_is_that_of_the_same_time_without_pushes():
    error = np.where(PUSHED, 3.0, -8.0)
    assert disturbed(theta=chirp(TIME_S) - error)["error_ratio"] == pytest.approx(1.5)


def test_pressure_error_is_a_share_of_the_span_of_the_command():
    command, tone = 100.0 + 2.0 * chirp(TIME_S), np.sin(2 * np.pi * 7.0 * TIME_S)
    log = {"p_exp_command_kpa": command, "p_exp_kpa": command + 3.0,
           "p_i_command_kpa": 2.0 * command, "p_i_kpa": 2.0 * command + 4.0 * tone}  # fmt: skip
    span = float(np.ptp(command))
    expected = {"main": 3.0 / span, "reservoir": 4.0 / 2**0.5 / (2.0 * span)}
    assert measure_pressure_error(log) == pytest.approx(expected, rel=1e-3)


LOOP = ("swing", "width_quarter", "width_half", "width_three_quarters", "slope")


def hysteresis(**widths):
    """Loops whose widths are given as functions of time; a sine from 0.1 to 1 Hz."""
    time_s = np.arange(int(60 * RATE_HZ)) / RATE_HZ
    phase = 2 * np.pi * time_s * (0.1 + 0.45 * time_s / 60.0)
    log = {"time_s": time_s, "theta_deg": 30.0 - 30.0 * np.cos(phase)}
    for name, width in widths.items():
        log[name] = 175.0 - 175.0 * np.cos(phase) + 0.5 * width(time_s) * np.sin(phase)
    return log


def test_loops_of_one_shape_at_every_frequency_are_found_so():
    """At 200 Hz the samples beside a crossing lie far off it where the sweep is fast."""
    widths = {"p_exp_command_kpa": 50.0, "p_o_kpa": 80.0}
    found = measure_hysteresis(hysteresis(**{k: lambda t, w=w: w for k, w in widths.items()}))
    for loop in ("actuator", "reservoir"):
        assert found[loop] == pytest.approx(dict.fromkeys(LOOP, 1.0), abs=0.03)


def test_loops_are_compared_in_the_first_and_the_last_quarter():
    found = measure_hysteresis(hysteresis(
        p_exp_command_kpa=lambda t: np.where(t < 15.0, 60.0, np.where(t > 45.0, 90.0, 9.0)),
        p_o_kpa=lambda t: np.where(t < 15.0, 80.0, np.where(t > 45.0, 20.0, 1000.0)),
    ))  # fmt: skip
    for loop, width in (("actuator", 1.5), ("reservoir", 0.25)):
        for key in LOOP[1:4]:
            assert found[loop][key] == pytest.approx(width, rel=0.05)
        assert found[loop]["slope"] == pytest.approx(1.0, abs=0.02)


def test_swing_and_slope_of_p_o_are_compared_without_its_start_from_rest():
    log = hysteresis(p_exp_command_kpa=lambda t: 20.0)
    share = np.where(log["time_s"] > 30.0, 0.3, 0.5)
    noise = np.random.default_rng(1).normal(0.0, 0.1, len(share))
    p_o = np.where(log["time_s"] < 0.2, 99.0, 100.0 + share * log["theta_deg"] + noise)
    found = measure_hysteresis(log | {"p_o_kpa": p_o})["reservoir"]
    assert found["swing"] == pytest.approx(0.6, rel=0.05)
    assert found["slope"] == pytest.approx(0.6, rel=0.05)


def test_range_has_largest_angle_dead_zone_and_monotony():
    time_s = np.arange(int(40 * RATE_HZ)) / RATE_HZ
    command = 175.0 - 175.0 * np.cos(2 * np.pi * 0.2 * time_s)
    theta = np.clip(0.25 * (command - 70.0), 0.0, None)  # 1 deg at 74 kPa
    up = np.gradient(command) > 0
    log = {
        "theta_deg": theta,
        "p_exp_command_kpa": command,
        "p_o_kpa": 100.0 + theta + np.where(up, 5.0, 0.0),
    }
    found = measure_range(log)
    assert found["angle_deg"] == pytest.approx(70.0)
    assert found["dead_zone"] == pytest.approx(74.0 / 350.0, rel=0.03)
    assert found["monotony"] == pytest.approx(1.0, abs=0.02)
    folded = measure_range(log | {"p_o_kpa": 100.0 + np.abs(theta - 35.0)})
    assert folded["monotony"] < 0.5
    assert measure_range(log | {"theta_deg": 0.0 * theta})["dead_zone"] == 0.0
