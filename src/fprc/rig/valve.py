"""Proportional valve: second-order spool, dead zone, ISO 6358 flow."""

import math

from fprc.compiled import kernel

#: Pressure ratio above which a line replaces the ISO 6358 flow, whose slope is infinite at equal
#: pressures.
LINEAR_ABOVE_RATIO = 0.995


@kernel
def spool_acceleration(x, v, command, natural_frequency, damping_ratio):
    """Acceleration of the spool, in strokes per s^2.

    x'' = wn^2 (command - x) - 2 zeta wn x', with x and command in [-1, 1].
    """
    return natural_frequency**2 * (command - x) - 2.0 * damping_ratio * natural_frequency * v


@kernel
def opening(x, dead_zone, leak):
    """Open fraction of the edge that a positive spool position ``x`` opens.

    The exhaust edge is ``opening(-x, ...)``. ``leak`` is the clearance, open at every position.
    """
    return min(max((x - dead_zone) / (1.0 - dead_zone), 0.0), 1.0) + leak


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

    Parameters
    ----------
    conductance : float
        Sonic conductance times open fraction, mL/(s kPa).
    """
    if upstream_kpa_abs >= downstream_kpa_abs:
        ratio = downstream_kpa_abs / upstream_kpa_abs
        return conductance * upstream_kpa_abs * flow_function(ratio, critical_ratio)
    ratio = upstream_kpa_abs / downstream_kpa_abs
    return -conductance * downstream_kpa_abs * flow_function(ratio, critical_ratio)
