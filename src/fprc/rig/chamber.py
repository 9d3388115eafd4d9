"""Gas in a chamber: filled through a valve, or sealed and squeezed."""

from fprc.compiled import kernel

ATMOSPHERE_KPA = 101.325


@kernel
def pressure_rate(p_kpa_abs, flow_ml_per_s, volume_ml, volume_rate_ml_per_s, polytropic_index):
    """Rate of the absolute pressure, kPa/s: p' = n (q p_atm - p V') / V."""
    return (
        polytropic_index
        * (flow_ml_per_s * ATMOSPHERE_KPA - p_kpa_abs * volume_rate_ml_per_s)
        / volume_ml
    )


@kernel
def sealed_pressure(gas_kpa_ml, volume_ml):
    """Gauge pressure of a sealed chamber at the room's temperature, kPa.

    ``gas_kpa_ml`` is m R T of the enclosed gas.
    """
    return gas_kpa_ml / volume_ml - ATMOSPHERE_KPA
