import copy
import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.config import Settings, check
from fprc.config.rig import Rig
from fprc.config.section import limit_of, section_of
from fprc.control_laws import NEUTRAL_V, pressure_step
from fprc.devices.sim import SimulatedRig
from fprc.errors import ConfigError, FprcError
from fprc.rig import simulator

ATMOSPHERE_KPA = 101.325
RATE_HZ = 200.0


def start(rig, rate_hz=RATE_HZ, seed=1):
    return SimulatedRig(rig, seed=seed, run=0, sample_rate_hz=rate_hz)


def drive(rig, p_exp_kpa, k_in=7.0, rate_hz=RATE_HZ):
    """Follow a pressure with the paper's loops; return the true states and the readings."""
    device = start(rig, rate_hz)
    integrals, gains = (0.0, 0.0), (0.03, 0.05)
    states, readings = [], []
    for k, p_exp in enumerate(p_exp_kpa):
        device.wait_for(k)
        now = device.read()
        p_i = min(max(k_in * now.theta_deg, 0.0), 450.0)
        steps = [
            pressure_step(error, integral, gain, 1e-6, 1 / rate_hz, NEUTRAL_V)
            for error, integral, gain in zip(
                (p_exp - now.p_exp_kpa, p_i - now.p_i_kpa), integrals, gains, strict=True
            )
        ]
        volts, integrals = zip(*steps, strict=True)
        device.write(*volts)
        states.append(device.state)
        readings.append(now)
    return np.concatenate(states), np.array(readings)


def swing(frequency_hz, cycles, rate_hz=RATE_HZ):
    t = np.arange(round(cycles / frequency_hz * rate_hz)) / rate_hz
    return 175.0 - 175.0 * np.cos(2.0 * np.pi * frequency_hz * t)


def iso_6358(opening, p1, p2, c, b):
    if p2 > p1:
        return -iso_6358(opening, p2, p1, c, b)
    r = p2 / p1
    if r <= b:
        return c * opening * p1
    if r < 0.995:
        return c * opening * p1 * math.sqrt(1.0 - ((r - b) / (1.0 - b)) ** 2)
    end = math.sqrt(1.0 - ((0.995 - b) / (1.0 - b)) ** 2)
    return c * opening * p1 * end * (1.0 - r) / 0.005


def reference(rig, volts, duration_s, dt=2e-5):
    """Write out the equations of the design again and take plain Euler steps.

    ``volts(t)`` gives both voltages. Friction is found from play operators
    instead of the slip of the elements. Rows: p_main, p_i, p_o, theta, phi; gauge.
    """
    v, c, a, b, r = (
        SimpleNamespace(
            **{
                name: value if np.isscalar(value) else np.array(value)
                for name, value in rig[key].items()
            }
        )
        for key in ("valve", "main_chamber", "reservoir_chamber", "bending", "reservoir")
    )

    def flow(x, p):
        ends = (v.supply_kpa_abs, p), (p, ATMOSPHERE_KPA)
        edges = [min(max((y - v.dead_zone) / (1.0 - v.dead_zone), 0.0), 1.0) for y in (x, -x)]
        supply, exhaust = (
            iso_6358(edge + v.leak, *end, v.sonic_conductance_ml_per_s_kpa, 0.3)
            for edge, end in zip(edges, ends, strict=True)
        )
        return supply - exhaust

    def slip(play, travel, distance, weight):
        play[:] = np.maximum(travel - distance, np.minimum(travel + distance, play))
        return float(np.dot(weight, (travel - play) / distance))

    x, dx = [0.0, 0.0], [0.0, 0.0]
    p, p_i = ATMOSPHERE_KPA, ATMOSPHERE_KPA
    theta = origin = -b.preload_kpa / b.stop_stiffness_kpa_per_deg
    relaxed, play, play_s = (np.zeros(len(of)) for of in (b.relaxation_time_s, b.slip_weight,
                                                          r.slip_weight))  # fmt: skip
    omega = s = phi = 0.0
    rows = []
    for k in range(round(duration_s / dt)):
        wn, gauge, gauge_i = v.natural_frequency_rad_per_s, p - ATMOSPHERE_KPA, p_i - ATMOSPHERE_KPA
        for i, volt in enumerate(volts(k * dt)):
            ddx = wn**2 * ((volt - 5.0) / 5.0 - x[i]) - 2.0 * v.damping_ratio * wn * dx[i]
            x[i], dx[i] = x[i] + dt * dx[i], dx[i] + dt * ddx

        volume = c.volume_ml + c.volume_ml_per_deg * theta
        dp = flow(x[0], p) * ATMOSPHERE_KPA - p * c.volume_ml_per_deg * omega
        torque = gauge * (1.0 - b.gain_loss_per_deg * theta) - b.preload_kpa
        torque -= b.stiffness_kpa_per_deg * theta + b.cubic_stiffness_kpa_per_deg3 * theta**3
        torque -= float(np.dot(b.relaxation_stiffness_kpa_per_deg, theta - relaxed))
        torque -= b.damping_kpa_s_per_deg * omega
        dry = b.friction_kpa + b.friction_per_kpa * max(gauge, 0.0)
        torque -= dry * slip(play, theta - origin, b.slip_distance_deg, b.slip_weight)
        if theta < 0.0:
            torque -= b.stop_stiffness_kpa_per_deg * theta + b.stop_damping_kpa_s_per_deg * omega

        left = r.passive_volume_ml - s - r.bending_volume_ml_per_deg * phi
        p_o = (r.precharge_kpa + ATMOSPHERE_KPA) * r.passive_volume_ml / left - ATMOSPHERE_KPA
        dry = r.friction_kpa + r.friction_per_kpa * max(gauge_i, 0.0)
        net = gauge_i - dry * slip(play_s, s, r.slip_distance_ml, r.slip_weight)
        net -= r.squeeze_stiffness_kpa_per_ml * s
        net -= r.back_pressure_gain * (p_o - r.precharge_kpa)
        ds = net / r.squeeze_damping_kpa_s_per_ml
        ds = max(ds, 0.0) if s <= 0.0 else ds
        across = gauge_i - p_o + r.precharge_kpa
        dphi = (across / r.bending_stiffness_kpa_per_deg - phi) / r.bending_time_s

        rows.append((gauge, gauge_i, p_o, theta, phi))
        relaxed = relaxed + dt * (theta - relaxed) / b.relaxation_time_s
        p += dt * c.polytropic_index * dp / volume
        dp_i = flow(x[1], p_i) * ATMOSPHERE_KPA - p_i * ds
        p_i += dt * a.polytropic_index * dp_i / (a.volume_ml + s)
        theta, omega = theta + dt * omega, omega + dt * torque / b.inertia_kpa_s2_per_deg
        s, phi = s + dt * ds, phi + dt * dphi
    return np.array(rows)


def test_rig_agrees_with_plain_euler_on_the_equations_of_the_design(quiet_rig):
    quiet_rig["step_s"] = 5e-5
    quiet_rig["pressure_sensor"]["lag_s"] = 1e-4
    quiet_rig["bending"]["gain_loss_per_deg"] = 0.001
    duration_s = 0.6

    def volts(t):
        if t < 0.2:
            return 5.8, 5.5
        if t < 0.4:
            return 4.6, 5.9
        return 5.4, 4.5

    expected = reference(quiet_rig, volts, duration_s)[:: round(0.005 / 2e-5)]
    device = start(quiet_rig)
    rows = []
    for k in range(len(expected)):
        device.wait_for(k)
        # voltages are held over the tick that follows
        device.write(*volts((k + 0.5) / RATE_HZ))
        state = device.state
        gauge = (state[name][0] - ATMOSPHERE_KPA for name in ("p_main_kpa_abs", "p_i_kpa_abs"))
        of_p_o = state["sensed_kpa"][0, 2]
        rows.append((*gauge, of_p_o, state["theta_deg"][0], state["phi_deg"][0]))
    assert quiet_rig["valve"]["critical_pressure_ratio"] == 0.3
    found = np.array(rows)
    assert (np.ptp(found, axis=0) > (150.0, 100.0, 10.0, 20.0, 5.0)).all()
    np.testing.assert_allclose(found[:, :2], expected[:, :2], atol=1.0)
    # the transducer of P_o lags by 0.1 ms
    np.testing.assert_allclose(found[:, 2:], expected[:, 2:], atol=0.15)


def test_drift_is_an_exact_ornstein_uhlenbeck_process(rig):
    """One step decays and gains the exact variance; two half steps make one whole."""
    rig["drift"] |= {"sigma_kpa": 8.0, "time_s": 5.0}
    packed = simulator.parameters(rig)[0]
    state = simulator.initial_state(rig, np.random.default_rng(0))[0]

    def step(start_kpa, shock, seconds):
        state["drift_kpa"] = start_kpa
        simulator._drift(state, packed, shock, 0.0, seconds)
        return float(state["drift_kpa"])

    assert step(10.0, 0.0, 2.0) == pytest.approx(10.0 * math.exp(-2.0 / 5.0))
    assert step(0.0, 1.0, 2.0) ** 2 == pytest.approx(64.0 * (1.0 - math.exp(-4.0 / 5.0)))
    assert step(0.0, 1.0, 500.0) == pytest.approx(8.0)
    half = step(0.0, 1.0, 1.0) ** 2
    assert half * math.exp(-2.0 / 5.0) + half == pytest.approx(step(0.0, 1.0, 2.0) ** 2)


def test_runs_on_one_rig_share_its_instruments_but_not_their_noise(rig):
    first, second = (SimulatedRig(rig, seed=5, run=k, sample_rate_hz=200.0) for k in (0, 1))
    other = SimulatedRig(rig, seed=6, run=0, sample_rate_hz=200.0)
    assert first._simulated[2] == second._simulated[2]
    assert first._simulated[2] != other._simulated[2]
    assert first.read() != second.read()
    assert first.state["drift_kpa"] != second.state["drift_kpa"]


@pytest.mark.parametrize(
    ("section", "key", "value", "quantity"),
    [
        ("bending", "damping_kpa_s_per_deg", 50.0, "bending angle"),
        ("reservoir", "squeeze_damping_kpa_s_per_ml", 1e-4, "volume of PAM B"),
        ("main_chamber", "volume_ml", 1e-4, "pressure of the main chamber"),
        ("reservoir_chamber", "volume_ml", 1e-4, "pressure of PAM A"),
        ("reservoir", "squeeze_stiffness_kpa_per_ml", -1e4, "volume of PAM B"),
    ],
)
def test_divergence_names_quantity_and_time(quiet_rig, section, key, value, quantity):
    quiet_rig["main_chamber"]["volume_ml_per_deg"] = 0.0
    quiet_rig[section][key] = value
    device = start(quiet_rig)
    device.write(7.0, 7.0)
    with pytest.raises(FprcError, match=quantity) as caught:
        device.wait_for(400)
    failed_at = device._tick / RATE_HZ
    assert f"t = {failed_at:.3f} s" in str(caught.value)
    assert 0.0 < failed_at <= 2.0


@pytest.mark.parametrize(
    "changed",
    [
        {},
        {"reservoir": {"squeeze_damping_kpa_s_per_ml": 0.3}},
        {"reservoir": {"squeeze_damping_kpa_s_per_ml": 0.3, "slip_distance_ml": (0.01, 0.5, 1.2),
                       "friction_kpa": 40.0, "friction_per_kpa": 0.4}},
        {"bending": {"inertia_kpa_s2_per_deg": 2e-4, "slip_distance_deg": (0.1, 3, 7, 14)}},
    ],
)  # fmt: skip
def test_settings_are_integrated_finely_enough_or_refused(changed):
    """Ten times finer steps must show the same pressure and angle, or an error be reported."""
    command = swing(0.5, 1)
    found = []
    for step_s in (5e-4, 5e-5):
        try:
            rig = check({"rig": changed | {"step_s": step_s}}).rig.model_dump()
            rig["drift"]["sigma_kpa"] = 0.0
            states, _ = drive(rig, command)
        except (ConfigError, FprcError):
            return
        found.append(np.column_stack([states["theta_deg"], states["sensed_kpa"][:, 2]]))
    assert np.ptp(found[1], axis=0).min() > 20.0
    np.testing.assert_allclose(found[0], found[1], atol=2.0)


@st.composite
def rigs(draw):
    """Rigs whose mechanics and pneumatics lie anywhere within the declared ranges."""
    rig = copy.deepcopy(Settings().rig.model_dump())
    for name in ("main_chamber", "reservoir_chamber", "bending", "drift", "reservoir"):
        for key, field in section_of(Rig.model_fields[name]).model_fields.items():
            if key == "slip_weight":
                continue
            number, default = st.floats(*limit_of(field)[:2]), rig[name][key]
            is_list = isinstance(default, tuple)
            rig[name][key] = tuple(draw(number) for _ in default) if is_list else draw(number)
    return rig


@given(rigs())
def test_state_is_physical_or_the_divergence_is_reported(rig):
    rig["reservoir"] |= {"leak_ml_per_s_kpa": 0.0, "bending_volume_ml_per_deg": 0.0}
    command = 200.0 - 200.0 * np.cos(2.0 * np.pi * 0.8 * np.arange(250) / RATE_HZ)
    try:
        states, readings = drive(rig, command)
    except FprcError as error:
        assert "left its physical range at t = " in str(error)  # noqa: PT017
    else:
        assert all(np.isfinite(states[name]).all() for name in states.dtype.names)
        assert np.isfinite(readings).all()
        p_o, precharge = states["sensed_kpa"][:, 2], rig["reservoir"]["precharge_kpa"]
        assert p_o.min() >= precharge - 1e-6 * (precharge + ATMOSPHERE_KPA)


def test_readings_lie_on_the_grids_of_converter_and_angle_sensor(rig):
    _, readings = drive(rig, swing(0.5, 1))
    step_kpa = 20.0 / 65536.0 / 4.0 * 1000.0
    for column in (1, 3, 4):
        codes = (readings[:, column] + 250.0) / step_kpa
        np.testing.assert_allclose(codes, np.round(codes), atol=1e-6)
        assert len(set(np.round(codes))) > 20
    assert np.array_equal(readings[:, 2] * 64.0, np.round(readings[:, 2] * 64.0))
    assert np.ptp(readings[:, 2]) > 30.0


def test_transducer_follows_a_ramp_by_its_lag(quiet_rig):
    quiet_rig["pressure_sensor"]["lag_s"] = 0.01
    states, _ = drive(quiet_rig, swing(0.5, 1))
    t, p = states["time_s"], states["p_main_kpa_abs"] - ATMOSPHERE_KPA
    smooth = slice(50, -1)
    late = np.interp(t - 0.01, t, p)
    np.testing.assert_allclose(states["sensed_kpa"][smooth, 0], late[smooth], atol=1.5)
    assert np.abs(states["sensed_kpa"][smooth, 0] - p[smooth]).max() > 3.0


def test_angle_sensor_lives_on_its_own_clock(quiet_rig):
    """Read five times faster, its samples are held 4.94 ms and never older than that."""
    rate_hz = 1000.0
    states, readings = drive(quiet_rig, swing(2.0, 1, rate_hz), rate_hz=rate_hz)
    truth, seen = states["theta_deg"], readings[:, 2]
    moving = np.abs(states["omega_deg_per_s"]) > 60.0
    changes = np.flatnonzero(np.diff(seen) != 0.0) + 1
    held_ticks = np.diff(changes[moving[changes] & moving[changes - 5]])
    held_ticks = held_ticks[held_ticks < 8]
    assert len(held_ticks) > 20
    assert held_ticks.mean() == pytest.approx(1000.0 / 202.27, abs=0.05)
    # each reading is the quantised truth of some instant within the last sample period
    for k in range(10, len(seen)):
        window = truth[k - 5 : k + 1]
        assert window.min() - 1 / 128 - 1e-9 <= seen[k] <= window.max() + 1 / 128 + 1e-9
    assert np.abs(truth[moving] - seen[moving]).max() > 0.15


def test_channels_of_the_board_are_scanned_one_after_the_other(quiet_rig):
    """The second and third reading show the pressure of one and two delays later."""
    rate_hz, scan_s = 1000.0, 1e-3
    quiet_rig["converter"]["scan_s"] = scan_s
    device = start(quiet_rig, rate_hz)
    device.write(6.0, 6.0)
    t = np.arange(200) / rate_hz
    sensed, readings = [], []
    for instant in t:
        device.wait_for(round(rate_hz * instant))
        sensed.append(device.state["sensed_kpa"][0])
        readings.append(device.read())
    sensed, readings = np.array(sensed), np.array(readings)
    for channel, column in enumerate((1, 3, 4)):
        later = np.interp(t + channel * scan_s, t, sensed[:, channel])
        np.testing.assert_allclose(readings[20:-2, column], later[20:-2], atol=0.15)
    assert np.diff(sensed[20:, 1]).max() > 0.5
    assert np.diff(sensed[20:, 2]).max() > 0.08


def test_voltages_beyond_the_board_are_clamped(quiet_rig):
    ends = []
    for volts in ((10.0, 0.0), (25.0, -25.0)):
        device = start(quiet_rig)
        device.write(*volts)
        device.wait_for(10)
        ends.append(device.state)
    assert ends[0].tobytes() == ends[1].tobytes()
    np.testing.assert_allclose(ends[0]["spool"], [[1.0, -1.0]], atol=1e-3)
