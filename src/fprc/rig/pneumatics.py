"""Gas: through a proportional valve (spool, dead zone, ISO 6358 flow), and in a chamber."""

import math

from fprc.compiled import kernel

ATMOSPHERE_KPA = 101.325

#: Pressure ratio above which a line replaces the ISO 6358 flow, whose slope is infinite at equal
#: pressures.
LINEAR_ABOVE_RATIO = 0.995


@kernel
def spool_acceleration(valve, x, v, command):
    """Acceleration of the spool, in strokes per s^2.

    x'' = wn^2 (command - x) - 2 zeta wn x', with x and command in [-1, 1].
    """
    natural_frequency = valve.natural_frequency_rad_per_s
    return natural_frequency**2 * (command - x) - 2.0 * valve.damping_ratio * natural_frequency * v


@kernel
def opening(valve, x):
    """Open fraction of the edge that a positive spool position ``x`` opens; -x is the exhaust's.

    ``leak`` is the clearance, open at every position.
    """
    return min(max((x - valve.dead_zone) / (1.0 - valve.dead_zone), 0.0), 1.0) + valve.leak


@kernel
def flow_function(ratio, critical_ratio):
    """Return psi(p2 / p1) of ISO 6358: 1 where the flow is choked, 0 at 1."""
    if ratio <= critical_ratio:
        return 1.0
    if ratio >= 1.0:
        return 0.0
    nearest = min(ratio, LINEAR_ABOVE_RATIO)
    psi = math.sqrt(1.0 - ((nearest - critical_ratio) / (1.0 - critical_ratio)) ** 2)
    return psi * (1.0 - ratio) / (1.0 - nearest)


@kernel
def mass_flow(conductance, upstream_kpa_abs, downstream_kpa_abs, critical_ratio):
    """Flow through an orifice, mL/s ANR; negative if the downstream pressure is the higher one.

    The conductance is the sonic one times the open fraction, mL/(s kPa).
    """
    high = max(upstream_kpa_abs, downstream_kpa_abs)
    low = min(upstream_kpa_abs, downstream_kpa_abs)
    flow = conductance * high * flow_function(low / high, critical_ratio)
    return flow if upstream_kpa_abs >= downstream_kpa_abs else -flow


@kernel
def valve_flow(valve, spool, p_kpa_abs):
    """Flow through both edges of a valve into a chamber, mL/s ANR."""
    conductance, ratio = valve.sonic_conductance_ml_per_s_kpa, valve.critical_pressure_ratio
    supply, exhaust = opening(valve, spool) * conductance, opening(valve, -spool) * conductance
    flow_in = mass_flow(supply, valve.supply_kpa_abs, p_kpa_abs, ratio)
    return flow_in - mass_flow(exhaust, p_kpa_abs, ATMOSPHERE_KPA, ratio)


@kernel
def pressure_rate(p_kpa_abs, flow_ml_per_s, volume_ml, volume_rate_ml_per_s, polytropic_index):
    """Rate of the absolute pressure, kPa/s: p' = n (q p_atm - p V') / V."""
    power = flow_ml_per_s * ATMOSPHERE_KPA - p_kpa_abs * volume_rate_ml_per_s
    return polytropic_index * power / volume_ml


@kernel
def sealed_pressure(gas_kpa_ml, volume_ml):
    """Gauge pressure of a sealed chamber at the room's temperature, kPa.

    ``gas_kpa_ml`` is m R T of the enclosed gas.
    """
    return gas_kpa_ml / volume_ml - ATMOSPHERE_KPA
