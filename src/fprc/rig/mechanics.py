"""Mechanics: friction, the soft bending actuator, and the reservoir, which squeezes PAM B.

Friction is rate-independent: Maxwell-slip elements in parallel, or one Bouc-Wen element. Maxwell
slip is the default, because minor loops, which the complex signal has, close only with nonlocal
memory. Bouc-Wen and Dahl have none, and LuGre depends on the rate. But Maxwell slip is a sum of
stop operators, which favours models made of play operators. Under Bouc-Wen, friction also relaxes
in small cycles, so that P_o depends on the size of the swings.
"""

import math

from fprc.compiled import kernel

#: Friction laws, see ``friction``.
LAWS = ("maxwell_slip", "bouc_wen")

#: Slip distance of the Bouc-Wen element over the mean one of the Maxwell-slip elements: both then
#: dissipate the same work in cycles far beyond it, 4 X - 5 delta and 4 X - 4 sum_j w_j delta_j.
_SHARE = 0.8


@kernel
def friction(law, z, increment, slip_distance, weight):
    """Move the elements by ``increment``, in place; return their normalised force, in [-1, 1].

    Maxwell slip: z_j <- clip(z_j + increment, -delta_j, delta_j), with the force
    sum_j w_j z_j / delta_j; the weights sum to 1. The length of the array ``law`` is the position
    in ``LAWS``, counted from 1: as a field of a record it is known when the code is compiled, so
    the choice takes no time.
    """
    if len(law) == 2:
        return bouc_wen(z, increment, slip_distance, weight)
    force = 0.0
    for j in range(len(z)):
        z[j] = min(max(z[j] + increment, -slip_distance[j]), slip_distance[j])
        force += weight[j] * z[j] / slip_distance[j]
    return force


@kernel
def bouc_wen(z, increment, slip_distance, weight):
    """Move one Bouc-Wen element, whose deflection is ``z[0]``, and return its normalised force.

    dz = (1 - (sign(dx z) + 1) / 2 |z| / delta) dx, delta = 0.8 sum_j w_j delta_j; the force is
    z / delta. In the usual symbols, for the force: A = 1 / delta, beta = gamma = A / 2, n = 1.
    Exact for increments of any size: z moves by dx towards 0, and approaches delta exponentially
    beyond it (Ismail, Ikhouane and Rodellar 2009, Arch. Comput. Methods Eng. 16:161).
    """
    delta = 0.0
    for j in range(len(z)):
        delta += _SHARE * weight[j] * slip_distance[j]
    direction = math.copysign(1.0, increment)
    left = abs(increment) / delta
    force = direction * z[0] / delta
    if force < 0.0:
        unloading = min(left, -force)
        force += unloading
        left -= unloading
    force -= (1.0 - force) * math.expm1(-left)
    z[0] = direction * force * delta
    return direction * force


@kernel
def angular_acceleration(bending, theta, omega, relaxed, slip_force, p_kpa, disturbance_kpa):
    """Angular acceleration of the actuator, deg/s^2.

    J th'' = p (1 - g0 th) + d - c th' - g_p - k1 th - k3 th^3
             - sum_j kve_j (th - e_j) - (Tc + mu p) slip - stop(th)

    stop(th) is a stiff, damped spring below 0 deg, where the actuator is straight. It makes the
    dead zone at the bottom of the loop. ``relaxed`` are the angles of the standard linear solids,
    e_j' = (th - e_j) / tau_j; ``slip_force`` is the normalised friction.
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
