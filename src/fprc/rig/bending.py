"""Mechanics of the soft bending actuator."""

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
