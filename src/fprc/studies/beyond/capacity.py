"""Information processing capacity of states driven by random input."""

from collections import Counter
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
from scipy.special import chdtri

from fprc.errors import EvaluationError

#: Factor on the quantile of the threshold (Dambre et al. 2012): targets that share inputs are not
#: independent in a finite sample.
_MARGIN = 2.0
#: Singular values of the normalised states below this share of the largest count as 0. Without
#: noise, a readout could otherwise use differences that no sensor resolves.
_TOLERANCE = 1e-6


def processing_capacity(
    u: np.ndarray,
    states: np.ndarray,
    *,
    max_delay: int,
    max_degree: int,
    p: float = 1e-4,
) -> dict[str, Any]:
    """Return the information processing capacities of the states (Dambre et al. 2012).

    A target is a product of Legendre polynomials of delayed inputs. Its capacity is 1 - MSE / var
    of the best linear readout with a bias. The fit and the capacity use the same samples. A target
    that the states know nothing about therefore gets about rank / n_samples; an estimate that such
    a target would exceed with the probability ``p``, or less, counts as 0.

    With ``max_degree`` 1, the sum over the delays is the short-term memory capacity (Jaeger 2002),
    here with the present input, delay 0.

    Parameters
    ----------
    u : ndarray of shape (n_samples,)
        Independent inputs, uniform in [-1, 1].
    states : ndarray of shape (n_samples, n_states)
        States after each input.
    max_delay : int
        Longest delay, samples. The first ``max_delay`` states are not used.
    max_degree : int
        Highest total degree of a target.
    p : float
        Probability of the threshold.

    Returns
    -------
    dict
        Number of ``states``; ``rank``, that of linearly independent ones, the upper bound of the
        total; ``threshold``, below which an estimate counts as 0; ``by_degree``, the sum over the
        targets of degree 1, 2, ...; ``by_delay``, of the input itself, delayed by 0, 1, ...

    Raises
    ------
    EvaluationError
        A state is not finite, or there are too few samples for the number of independent states.

    References
    ----------
    Jaeger 2002, GMD report 152; Dambre, Verstraeten, Schrauwen and Massar 2012,
    Sci. Rep. 2:514.
    """
    if not np.isfinite(states).all():
        raise EvaluationError("a state is not finite, so there is no capacity; check the rig")
    basis = _orthonormal(states[max_delay:])
    samples, rank = basis.shape
    threshold = _MARGIN * float(chdtri(rank, p)) / samples if rank else 1.0
    if rank and threshold >= 1.0:
        raise EvaluationError(
            f"{samples} samples are too few for the capacities of {rank} independent states: "
            "chance alone could reach 1; use more samples or fewer states"
        )
    degrees = range(1, max_degree + 1)
    targets = [
        delays
        for degree in degrees
        for delays in combinations_with_replacement(range(max_delay + 1), degree)
    ]
    capacity = _capacities(_polynomials(u, max_delay, max_degree), targets, basis)
    capacity[capacity < threshold] = 0.0
    degree_of = np.array([len(delays) for delays in targets])
    return {
        "states": states.shape[1],
        "rank": rank,
        "threshold": threshold,
        "by_degree": {
            str(degree): float(capacity[degree_of == degree].sum()) for degree in degrees
        },
        "by_delay": capacity[: max_delay + 1].tolist(),
    }


def _orthonormal(states: np.ndarray) -> np.ndarray:
    """Return orthonormal columns that span the states, each without its mean."""
    centred = states - states.mean(axis=0)
    centred = centred[:, np.ptp(states, axis=0) > 0.0]
    if not centred.size:
        return np.empty((len(states), 0))
    centred /= np.linalg.norm(centred, axis=0)
    left, singular, _ = np.linalg.svd(centred, full_matrices=False)
    return left[:, singular > _TOLERANCE * singular[0]]


def _polynomials(u: np.ndarray, max_delay: int, max_degree: int) -> np.ndarray:
    """Return Legendre polynomials of the delayed inputs, indexed by degree and delay."""
    values = np.polynomial.legendre.legvander(u, max_degree).T
    kept = len(u) - max_delay
    return np.stack([values[:, max_delay - d :][:, :kept] for d in range(max_delay + 1)], axis=1)


def _capacities(
    polynomials: np.ndarray, targets: list[tuple[int, ...]], basis: np.ndarray
) -> np.ndarray:
    """Return the share of each target's variance that lies in the span of ``basis``."""
    wanted = np.ones((len(targets), polynomials.shape[-1]))
    for row, delays in zip(wanted, targets, strict=True):
        for delay, degree in Counter(delays).items():
            row *= polynomials[degree, delay]
    wanted -= wanted.mean(axis=1, keepdims=True)
    return ((wanted @ basis) ** 2).sum(axis=1) / (wanted**2).sum(axis=1)
