"""Rate-independent hysteresis: Maxwell-slip elements in parallel.

Chosen over Bouc-Wen (minor loops need not close), Dahl (one scale) and LuGre
(rate-dependent): the complex signal's minor loops need nonlocal memory.
"""

from fprc.compiled import kernel


@kernel
def slip(z, increment, slip_distance, weight):
    """Move the elements by ``increment`` and return their normalised force.

    z_j <- clip(z_j + increment, -delta_j, delta_j); the force is
    sum_j w_j z_j / delta_j, which lies in [-1, 1] where the weights sum to 1.

    Parameters
    ----------
    z : ndarray of shape (n_elements,)
        Deflections, changed in place, in the unit of ``increment``.
    """
    force = 0.0
    for j in range(len(z)):
        z[j] = min(max(z[j] + increment, -slip_distance[j]), slip_distance[j])
        force += weight[j] * z[j] / slip_distance[j]
    return force
