"""Rate-independent hysteresis: Maxwell-slip elements in parallel, or one Bouc-Wen element.

Maxwell slip is the default, because minor loops, which the complex signal has, close only with
nonlocal memory. Bouc-Wen and Dahl have none, and LuGre depends on the rate. But Maxwell slip is a
sum of stop operators, which favours models made of play operators. Under Bouc-Wen, friction also
relaxes in small cycles, so that P_o depends on the size of the swings.
"""

import math

from fprc.compiled import kernel

#: Friction laws; compiled code identifies a law by the length of an array: 1, 2, ...
LAWS = ("maxwell_slip", "bouc_wen")

#: Slip distance of the Bouc-Wen element over the mean one of the Maxwell-slip elements: both then
#: dissipate the same work in cycles far beyond it, 4 X - 5 delta and 4 X - 4 sum_j w_j delta_j.
_SHARE = 0.8


@kernel
def friction(law, z, increment, slip_distance, weight):
    """Move the elements by ``increment`` and return their normalised force, in [-1, 1].

    The length of the array ``law`` is the position in ``LAWS``, counted from 1. As a field of a
    record it has a length that is known when the code is compiled, so the choice takes no time.
    """
    if len(law) == 2:
        return bouc_wen(z, increment, slip_distance, weight)
    return slip(z, increment, slip_distance, weight)


@kernel
def slip(z, increment, slip_distance, weight):
    """Move the elements by ``increment`` and return their normalised force.

    z_j <- clip(z_j + increment, -delta_j, delta_j); the force is
    sum_j w_j z_j / delta_j, which lies in [-1, 1] where the weights sum to 1. The deflections z
    are changed in place.
    """
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
    The solution is exact for increments of any size: z moves by dx towards 0, and approaches
    delta exponentially beyond it.

    References
    ----------
    Ismail, Ikhouane and Rodellar 2009, Arch. Comput. Methods Eng. 16:161.
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
