"""Dual-PAM reservoir: the active chamber squeezes the sealed passive one."""

from fprc.rig.compiled import kernel


@kernel
def squeeze_rate(reservoir, squeezed_ml, slip_force, p_active_kpa, p_passive_kpa):
    """Rate of the volume squeezed out of the passive chamber, mL/s.

    c_s s' = p_A - (Tc + mu p_A) slip - k_s s - g (P_o - P_o(0))

    The squeeze is not coupled to the reservoir's bending: the fabric is pulled
    by the inflation of the active chamber alone, which is the paper's own
    explanation of why disturbances leave P_o alone (Sec. IV).
    """
    friction = reservoir.friction_kpa + reservoir.friction_per_kpa * max(p_active_kpa, 0.0)
    net = p_active_kpa - friction * slip_force
    net -= reservoir.squeeze_stiffness_kpa_per_ml * squeezed_ml
    net -= reservoir.back_pressure_gain * (p_passive_kpa - reservoir.precharge_kpa)
    return net / reservoir.squeeze_damping_kpa_s_per_ml
