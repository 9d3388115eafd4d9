"""Dual-PAM reservoir: the active chamber squeezes the sealed passive one."""

from fprc.compiled import kernel


@kernel
def squeeze_rate(reservoir, squeezed_ml, slip_force, p_active_kpa, p_passive_kpa):
    """Rate of the volume squeezed out of the passive chamber, mL/s.

    c_s s' = p_A - (Tc + mu p_A) slip - k_s s - g (P_o - P_o(0))

    Bending of the reservoir does not drive the squeeze: only the inflation of the active chamber
    pulls the fabric. The paper explains in this way why disturbances do not change P_o (Sec. IV).
    """
    friction = reservoir.friction_kpa + reservoir.friction_per_kpa * max(p_active_kpa, 0.0)
    net = p_active_kpa - friction * slip_force
    net -= reservoir.squeeze_stiffness_kpa_per_ml * squeezed_ml
    net -= reservoir.back_pressure_gain * (p_passive_kpa - reservoir.precharge_kpa)
    return net / reservoir.squeeze_damping_kpa_s_per_ml


@kernel
def bending_rate(reservoir, phi, p_active_kpa, p_passive_kpa, push_kpa):
    """Rate of the reservoir's bending angle, deg/s.

    tau phi' = (p_A - P_o + P_o(0) + push) / k - phi, where push is an external force in kPa.
    No model uses phi, but bending takes a little volume from PAM B.
    """
    drive = p_active_kpa - p_passive_kpa + reservoir.precharge_kpa + push_kpa
    return (drive / reservoir.bending_stiffness_kpa_per_deg - phi) / reservoir.bending_time_s


@kernel
def passive_volume(reservoir, squeezed_ml, phi):
    """Volume of the gas in PAM B, mL."""
    bent = reservoir.bending_volume_ml_per_deg * phi
    return reservoir.passive_volume_ml - squeezed_ml - bent
