"""The whole rig as one state that is advanced tick by tick.

Two valves, the bending actuator, the dual-PAM reservoir and the sensors. Integration is
semi-implicit Euler.
"""

import math
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

from fprc.channels import CHANNELS
from fprc.compiled import kernel
from fprc.rig import mechanics, pneumatics
from fprc.rig.pneumatics import ATMOSPHERE_KPA

#: Standard normal numbers per tick: noise of three pressure sensors, the drift, the slow error of
#: the bend sensor, and noise of up to two samples of both angles.
NOISE_PER_TICK = 9

#: A record of every channel of a log.
SAMPLE = np.dtype([(channel.name, float) for channel in CHANNELS])

#: Codes that ``advance`` returns when a quantity leaves its physical range.
DIVERGED = {1: "pressure of the main chamber", 2: "pressure of PAM A", 3: "bending angle",
            4: "volume of PAM B", 5: "spool of a valve"}  # fmt: skip


def record(settings: Mapping[str, Any]) -> np.ndarray:
    """Pack nested numbers into a structured array of shape (1,).

    Numbers become float64 fields, sequences fixed-length arrays, mappings nested records; names
    and order are kept, in Python and in compiled code.
    """
    values: list[Any] = []
    fields: list[Any] = []
    for name, value in settings.items():
        if isinstance(value, Mapping):
            nested = record(value)
            values.append(nested[0])
            fields.append((name, nested.dtype))
        else:
            values.append(value)
            fields.append((name, float, np.shape(value)))
    return np.array([tuple(values)], dtype=_layout(tuple(fields)))


@cache
def _layout(fields: tuple[Any, ...]) -> np.dtype:
    # one object per layout: numba compares two equal dtypes for longer than a tick takes
    return np.dtype([*fields])


def parameters(rig: Mapping[str, Any]) -> np.ndarray:
    """Return a rig's parameters for compiled code; ``friction`` explains how it gets the law."""
    return record({**rig, "friction_law": [0.0] * (1 + mechanics.LAWS.index(rig["friction_law"]))})


def initial_state(rig: Mapping[str, Any], rng: np.random.Generator) -> np.ndarray:
    """State of a rig at rest: vented, straight, passive chamber pre-charged.

    The drift, and the bend sensor's slow error and phase, are drawn from ``rng``.
    """
    bending, reservoir = rig["bending"], rig["reservoir"]
    gas = (reservoir["precharge_kpa"] + ATMOSPHERE_KPA) * reservoir["passive_volume_ml"]
    return record(
        {
            "time_s": 0.0,
            "spool": [0.0, 0.0],
            "spool_rate": [0.0, 0.0],
            "p_main_kpa_abs": ATMOSPHERE_KPA,
            "theta_deg": -bending["preload_kpa"] / bending["stop_stiffness_kpa_per_deg"],
            "omega_deg_per_s": 0.0,
            "relaxed_deg": [0.0] * len(bending["relaxation_time_s"]),
            "bending_slip_deg": [0.0] * len(bending["slip_distance_deg"]),
            "drift_kpa": rig["drift"]["sigma_kpa"] * rng.standard_normal(),
            "p_i_kpa_abs": ATMOSPHERE_KPA,
            "squeezed_ml": 0.0,
            "phi_deg": 0.0,
            "passive_gas_kpa_ml": gas,
            "squeeze_slip_ml": [0.0] * len(reservoir["slip_distance_ml"]),
            "sensed_kpa": [0.0, 0.0, reservoir["precharge_kpa"]],
            "sensed_rate_kpa_per_s": [0.0, 0.0, 0.0],
            "bend_next_s": -rng.uniform() / rig["bend_sensor"]["rate_hz"],
            "bend_slow_deg": rig["bend_sensor"]["slow_error_deg"] * rng.standard_normal(),
            "bend_held_deg": 0.0,
            "phi_held_deg": 0.0,
        }
    )


def draw_instruments(rig: Mapping[str, Any], rng: np.random.Generator) -> np.ndarray:
    """Calibration errors of the three pressure sensors, drawn once per rig.

    Gain, offset and bow share the linearity that the data sheet allows. The order of the sensors,
    here and in every array of three, is P_exp, P_i, P_o.
    """
    share = rig["pressure_sensor"]["linearity"] / 3.0
    errors = rng.uniform(-share, share, size=(3, 3))
    return record(dict(zip(("gain", "offset", "bow"), errors, strict=True)))


@kernel
def advance(states, rigs, instruments, valve_v, push_kpa, noise, period_s, substeps, reading):
    """Advance the rig by ``substeps`` steps of ``period_s / substeps`` and read its sensors.

    Return 0, or a key of ``DIVERGED``. Of the first three, records of shape (1,), the state is
    changed; the channels of the sensors in ``reading``, a ``SAMPLE``, are filled. ``valve_v``, of
    the main and the reservoir valve, and ``push_kpa``, which bends the reservoir, are held over the
    tick; ``noise`` is standard normal. Without substeps only the sensors are read.
    """
    state, rig = states[0], rigs[0]
    dt = period_s / max(substeps, 1)
    bend_noise = 5
    if substeps > 0:
        _drift(state, rig, noise[3], noise[4], period_s)
    for _ in range(substeps):
        _valves(state, rig, valve_v, dt)
        _actuator(state, rig, dt)
        _reservoir(state, rig, push_kpa, dt)
        _lag_of_sensors(state, rig, dt)
        state.time_s += dt
        bend_noise = _bend_sample(state, rig, noise, bend_noise)
        failed = _diverged(state, rig)
        if failed:
            return failed
    if substeps == 0:
        _bend_sample(state, rig, noise, bend_noise)
    _sense(state, rig, instruments[0], noise, reading[0])
    return 0


@kernel
def _drift(state, rig, shock, bend_shock, period_s):
    drift, bend = rig.drift, rig.bend_sensor
    keep = math.exp(-period_s / drift.time_s)
    gained = drift.sigma_kpa * math.sqrt(1.0 - keep * keep) * shock
    state.drift_kpa = keep * state.drift_kpa + gained
    keep = math.exp(-period_s / bend.slow_error_time_s)
    gained = bend.slow_error_deg * math.sqrt(1.0 - keep * keep) * bend_shock
    state.bend_slow_deg = keep * state.bend_slow_deg + gained


@kernel
def _valves(state, rig, valve_v, dt):
    valve = rig.valve
    for i in range(2):
        written = converted(valve_v[i], rig.converter.step_v, rig.converter.limit_v)
        volts = max(written, 0.0)  # the output board gives 0 to 10 V
        command = (volts - valve.neutral_v) / valve.neutral_v
        x, v = state.spool[i], state.spool_rate[i]
        state.spool_rate[i] += dt * pneumatics.spool_acceleration(valve, x, v, command)
        state.spool[i] += dt * state.spool_rate[i]


@kernel
def _actuator(state, rig, dt):
    chamber, bending = rig.main_chamber, rig.bending
    volume = chamber.volume_ml + chamber.volume_ml_per_deg * state.theta_deg
    volume_rate = chamber.volume_ml_per_deg * state.omega_deg_per_s
    flow = pneumatics.valve_flow(rig.valve, state.spool[0], state.p_main_kpa_abs)
    state.p_main_kpa_abs += dt * pneumatics.pressure_rate(
        state.p_main_kpa_abs, flow, volume, volume_rate, chamber.polytropic_index
    )
    force = mechanics.friction(
        rig.friction_law, state.bending_slip_deg, dt * state.omega_deg_per_s,
        bending.slip_distance_deg, bending.slip_weight,
    )  # fmt: skip
    p_kpa = state.p_main_kpa_abs - ATMOSPHERE_KPA
    state.omega_deg_per_s += dt * mechanics.angular_acceleration(
        bending, state.theta_deg, state.omega_deg_per_s, state.relaxed_deg, force, p_kpa,
        state.drift_kpa,
    )  # fmt: skip
    state.theta_deg += dt * state.omega_deg_per_s
    for j in range(len(state.relaxed_deg)):
        away = state.theta_deg - state.relaxed_deg[j]
        state.relaxed_deg[j] += dt * away / bending.relaxation_time_s[j]


@kernel
def _reservoir(state, rig, push_kpa, dt):
    chamber, reservoir = rig.reservoir_chamber, rig.reservoir
    passive_ml = mechanics.passive_volume(reservoir, state.squeezed_ml, state.phi_deg)
    p_o = pneumatics.sealed_pressure(state.passive_gas_kpa_ml, passive_ml)
    state.passive_gas_kpa_ml -= dt * reservoir.leak_ml_per_s_kpa * p_o * ATMOSPHERE_KPA
    before, p_i = state.squeezed_ml, state.p_i_kpa_abs - ATMOSPHERE_KPA
    force = _squeeze_friction(state, rig, 0.0)
    rate = mechanics.squeeze_rate(reservoir, before, force, p_i, p_o)
    state.phi_deg += dt * mechanics.bending_rate(reservoir, state.phi_deg, p_i, p_o, push_kpa)
    state.squeezed_ml = max(before + dt * rate, 0.0)
    rate = (state.squeezed_ml - before) / dt
    _squeeze_friction(state, rig, rate * dt)
    volume = chamber.volume_ml + state.squeezed_ml
    flow = pneumatics.valve_flow(rig.valve, state.spool[1], state.p_i_kpa_abs)
    state.p_i_kpa_abs += dt * pneumatics.pressure_rate(
        state.p_i_kpa_abs, flow, volume, rate, chamber.polytropic_index
    )


@kernel
def _squeeze_friction(state, rig, increment):
    distance, weight = rig.reservoir.slip_distance_ml, rig.reservoir.slip_weight
    return mechanics.friction(rig.friction_law, state.squeeze_slip_ml, increment, distance, weight)


@kernel
def _lag_of_sensors(state, rig, dt):
    passive_ml = mechanics.passive_volume(rig.reservoir, state.squeezed_ml, state.phi_deg)
    truth = (
        state.p_main_kpa_abs - ATMOSPHERE_KPA,
        state.p_i_kpa_abs - ATMOSPHERE_KPA,
        pneumatics.sealed_pressure(state.passive_gas_kpa_ml, passive_ml),
    )
    keep = math.exp(-dt / rig.pressure_sensor.lag_s)
    for i in range(3):
        before = state.sensed_kpa[i]
        state.sensed_kpa[i] = truth[i] + keep * (before - truth[i])
        state.sensed_rate_kpa_per_s[i] = (state.sensed_kpa[i] - before) / dt


@kernel
def _bend_sample(state, rig, noise, column):
    sensor = rig.bend_sensor
    while state.bend_next_s <= state.time_s:
        sample = min(column, 6)
        angle = state.theta_deg + state.bend_slow_deg + sensor.noise_deg * noise[sample]
        state.bend_held_deg = quantise(angle, sensor.step_deg)
        # the reservoir's sensor is on the same bus and so samples at the same time
        angle = state.phi_deg + sensor.noise_deg * noise[sample + 2]
        state.phi_held_deg = quantise(angle, sensor.step_deg)
        state.bend_next_s += 1.0 / sensor.rate_hz
        column += 1
    return column


@kernel
def quantise(value, step):
    """Round to the nearest multiple of ``step``."""
    return math.floor(value / step + 0.5) * step


@kernel
def pressure_voltage(sensor, p_kpa, gain_error, offset_error, bow_error, noise_kpa):
    """Output of a pressure transducer, V, before the converter.

    The errors are shares of full scale; the bow is a parabola, zero at both ends of the range.
    """
    x = p_kpa / sensor.full_scale_kpa
    x += gain_error * x + offset_error + bow_error * 4.0 * x * (1.0 - x)
    x += noise_kpa / sensor.full_scale_kpa
    return sensor.zero_v + sensor.span_v * x


@kernel
def converted(voltage, step_v, limit_v):
    """Voltage after a converter of the given step, clipped to +- its limit."""
    return quantise(min(max(voltage, -limit_v), limit_v), step_v)


@kernel
def _sense(state, rig, instrument, noise, reading):
    sensor = rig.pressure_sensor
    kpa_per_v = sensor.full_scale_kpa / sensor.span_v
    pressures = np.empty(3)
    for i in range(3):
        # the board converts its channels one after the other
        p_kpa = state.sensed_kpa[i] + i * rig.converter.scan_s * state.sensed_rate_kpa_per_s[i]
        volts = pressure_voltage(
            sensor, p_kpa, instrument.gain[i], instrument.offset[i], instrument.bow[i],
            sensor.noise_kpa * noise[i],
        )  # fmt: skip
        volts = converted(volts, rig.converter.step_v, rig.converter.limit_v)
        pressures[i] = (volts - sensor.zero_v) * kpa_per_v
    reading.p_exp_kpa, reading.p_i_kpa, reading.p_o_kpa = pressures[0], pressures[1], pressures[2]
    reading.theta_deg, reading.phi_deg = state.bend_held_deg, state.phi_held_deg


@kernel
def _diverged(state, rig):
    # `not (... < ...)`: NaN, too, is out of range
    if not (0.0 < state.p_main_kpa_abs < 2.0 * rig.valve.supply_kpa_abs):
        return 1
    if not (0.0 < state.p_i_kpa_abs < 2.0 * rig.valve.supply_kpa_abs):
        return 2
    if not (-180.0 < state.theta_deg < 180.0):
        return 3
    left_ml = mechanics.passive_volume(rig.reservoir, state.squeezed_ml, state.phi_deg)
    if not (0.01 * rig.reservoir.passive_volume_ml < left_ml):
        return 4
    if not (abs(state.spool[0]) < 2.0 and abs(state.spool[1]) < 2.0):
        return 5
    return 0
