"""Sensors of the rig: pressure transducers, converters, bend sensor."""

import math

from fprc.compiled import kernel


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
