"""Mechanics: of the soft bending actuator, and of the dual-PAM reservoir, which squeezes PAM B."""

from fprc.compiled import kernel


@kernel
def angular_acceleration(bending, theta, omega, relaxed, slip_force, p_kpa, disturbance_kpa):
    """Angular acceleration of the actuator, deg/s^2.

    J th'' = p (1 - g0 th) + d - c th' - g_p - k1 th - k3 th^3
             - sum_j kve_j (th - e_j) - (Tc + mu p) slip - stop(th)

    stop(th) is a stiff, damped spring below 0 deg, where the actuator is straight. It makes the
    dead zone at the bottom of the loop.

    Parameters
    ----------
    bending : record
        Parameters, see ``fprc.config.rig.Bending``.
    relaxed : ndarray
        e_j, the relaxed angles of the standard linear solids, deg.
    slip_force : float
        Normalised force of the Maxwell-slip elements.
    """
    torque = p_kpa * (1.0 - bending.gain_loss_per_deg * theta) + disturbance_kpa
    torque -= bending.preload_kpa + bending.damping_kpa_s_per_deg * omega
    torque -= bending.stiffness_kpa_per_deg * theta
    torque -= bending.cubic_stiffness_kpa_per_deg3 * theta**3
    for j in range(len(relaxed)):
        torque -= bending.relaxation_stiffness_kpa_per_deg[j] * (theta - relaxed[j])
    torque -= (bending.friction_kpa + bending.friction_per_kpa * max(p_kpa, 0.0)) * slip_force
    if theta < 0.0:
        torque -= bending.stop_stiffness_kpa_per_deg * theta
        torque -= bending.stop_damping_kpa_s_per_deg * omega
    return torque / bending.inertia_kpa_s2_per_deg


@kernel
def relax(relaxed, theta, relaxation_time_s, dt):
    """Advance the relaxed angles in place: e_j' = (th - e_j) / tau_j."""
    for j in range(len(relaxed)):
        relaxed[j] += dt * (theta - relaxed[j]) / relaxation_time_s[j]


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
