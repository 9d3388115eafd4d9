"""Memory and capacity of a reservoir's state, for an input that may be correlated."""

from collections.abc import Iterator, Mapping
from itertools import combinations_with_replacement
from math import comb
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fprc.errors import EvaluationError
from fprc.models import LowpassBank

#: Time constants of the low-passes of the state of ``filtered_capacity``, s.
TIMES_S = (0.15, 0.5, 1.7)
#: Its lags of theta: spacing and number; theta's own newest taps do not count in the memory curve.
SPACING_S, LAGS, TAPS = 0.1, 50, 5
#: Directions of a state or of the targets below this share of the largest are rounding errors.
_RANK = 1e-9
#: Blocks that test the memory curve, and its ridge parameter, a share of the samples.
_BLOCKS, _ALPHA = 10, 1e-6


class Capacity(NamedTuple):
    """Memory and capacity of a state."""

    degrees: np.ndarray  #: sum of the capacities of each degree, from 1
    #: Share of the variance of each product of lagged inputs that the state explains, above chance,
    #: by the lags of its factors, samples.
    targets: Mapping[tuple[int, ...], float]
    rank: int  #: of the state: the sum of all capacities cannot exceed it
    lags_s: np.ndarray  #: lags of the memory curve, s
    #: Share of the variance of each lagged input that the state adds to the input's own taps, on
    #: unseen blocks; 0 where a shifted state adds as much.
    memory: np.ndarray
    memory_s: float  #: area under the curve, s


def capacity(
    state: ArrayLike, u: ArrayLike, *, rate_hz: float = 1.0, lags: int = 50, spacing: int = 1,
    degree: int = 3, most: int = 150, taps: int = 1, shifts: int = 19,
) -> Capacity:  # fmt: skip
    """Return what a state remembers of its input: memory curve, and capacity by degree.

    The targets are products of lagged inputs, z(k - l1) z(k - l2) ... of the standardised input z,
    made orthogonal to a constant and to each other on the recording itself (Gram-Schmidt), in the
    order of degree and then of lags. The capacity of a target is the share of its variance that a
    linear function of the state explains (R^2), less what states shifted in time explain in the
    mean, over the rest; it is 0 unless it exceeds that of all shifted states.

    For an independent input this is the information processing capacity of Dambre and others, and
    degree 1 the memory capacity of Jaeger. A correlated input changes what the sum means, not
    its limit: a target is the part of a product that earlier targets leave, what two of them share
    counts for the earlier one, and what is nearly determined by the past is measured on a small
    rest. So sums of different inputs cannot be compared; those of two states on one input can.

    Parameters
    ----------
    state : array-like of shape (n_samples, n_states)
        State of a reservoir after each sample; a single one may have shape (n_samples,).
    u : array-like of shape (n_samples,)
        Its input.
    rate_hz : float, default=1.0
        Samples a second.
    lags, spacing : int, default=50, 1
        Number of lags, from 0 on, and samples from one to the next.
    degree, most : int, default=3, 150
        Highest degree; most targets of each degree from 2 on: products of the first lags.
    taps : int, default=1
        Newest inputs, one sample apart, beyond which the memory curve counts.
    shifts : int, default=19
        Shifted states, each by another time; 19 make thresholds of 5 %.

    Raises
    ------
    EvaluationError
        The arrays differ in length, hold NaN, or have too few samples for the lags and shifts.

    References
    ----------
    Dambre, Verstraeten, Schrauwen and Massar, Scientific Reports 2 (2012), 514. Kubota, Takahashi
    and Nakajima, Physical Review Research 3 (2021), 043135, for other inputs. Jaeger, GMD Report
    152 (2002).
    """
    states, inputs = np.asarray(state, dtype=float), np.asarray(u, dtype=float)
    states = states.reshape(len(states), -1)
    finite = np.isfinite(states).all() and np.isfinite(inputs).all()
    if inputs.shape != (len(states),) or not finite:
        raise EvaluationError("the state and the input must be finite, and of the same length")
    if len(inputs) < _least(lags, spacing, taps, shifts):
        raise EvaluationError(f"{len(inputs)} samples are too few for {lags} lags; use fewer")
    inputs = (inputs - inputs.mean()) / (inputs.std() or 1.0)
    reach = max((lags - 1) * spacing, taps - 1)
    past = np.lib.stride_tricks.sliding_window_view(inputs, reach + 1)[:, ::-1]
    own, spaced = past[:, :taps], past[:, : (lags - 1) * spacing + 1 : spacing]
    # an orthonormal basis of what the states span without their means
    states = states[reach:]
    spread = states.std(axis=0)
    moving = spread > _RANK * np.abs(states).max(axis=0)
    scaled = (states[:, moving] - states[:, moving].mean(axis=0)) / spread[moving]
    basis, sizes, _ = np.linalg.svd(scaled, full_matrices=False)
    basis = basis[:, sizes > _RANK * sizes.max(initial=0.0)]
    # of the states at other times, which span what their rolled basis spans
    moved = [
        np.roll(basis, round(share * len(basis)), axis=0)
        for share in np.linspace(0.0, 1.0, shifts + 2)[1:-1]
    ]
    names = [*_products(lags, degree, most)]
    products = [spaced[:, list(name)].prod(axis=1) for name in names]
    columns = np.column_stack([np.ones(len(basis)), *products])
    goals, sizes = np.linalg.qr(columns)
    left = np.abs(np.diag(sizes)) > _RANK * np.linalg.norm(columns, axis=0)
    found, *by_chance = (((one.T @ goals) ** 2).sum(axis=0) for one in (basis, *moved))
    mean, highest = np.mean(by_chance, axis=0), np.max(by_chance, axis=0)
    above = np.where(left & (found > highest), (found - mean) / np.maximum(1.0 - mean, _RANK), 0.0)
    shares = np.clip(above, 0.0, 1.0)[1:].tolist()
    targets = {tuple(spacing * k for k in name): x for name, x in zip(names, shares, strict=True)}
    curve = _memory(basis, own, spaced)
    chance = np.max([_memory(other, own, spaced) for other in moved], axis=0)
    memory = np.where(curve > np.maximum(chance, 0.0), curve, 0.0)
    sums = np.bincount([len(name) - 1 for name in names], shares, degree)
    lags_s, area = np.arange(lags) * (spacing / rate_hz), float(memory.sum()) * (spacing / rate_hz)
    return Capacity(sums, targets, basis.shape[1], lags_s, memory, area)


def filtered_capacity(signal: np.ndarray, theta: np.ndarray, rate_hz: float) -> Capacity:
    """Return the capacity of a signal and three low-passes of it, for theta as the input."""
    epsilons = [1.0 - np.exp(-1.0 / (time_s * rate_hz)) for time_s in TIMES_S]
    state = LowpassBank([1.0, *epsilons]).fit_transform(signal[:, None])
    spacing = _spacing(rate_hz)
    return capacity(state, theta, rate_hz=rate_hz, lags=LAGS, spacing=spacing, taps=TAPS)


def least_samples(rate_hz: float) -> int:
    """Return the fewest samples that ``filtered_capacity`` takes."""
    return _least(LAGS, _spacing(rate_hz), TAPS, 19)


def _spacing(rate_hz: float) -> int:
    """Return the samples from one lag of ``filtered_capacity`` to the next."""
    return max(1, round(SPACING_S * rate_hz))


def _least(lags: int, spacing: int, taps: int, shifts: int) -> int:
    return 2 * (lags * spacing + taps) + 10 * (shifts + 1)


def _products(lags: int, degree: int, most: int) -> Iterator[tuple[int, ...]]:
    """Yield the lags of each product, by degree and then by the latest lag."""
    for factors in range(1, degree + 1):
        reach = lags
        while factors > 1 and reach > 1 and comb(reach + factors - 1, factors) > most:
            reach -= 1
        yield from sorted(combinations_with_replacement(range(reach), factors), key=lambda x: x[-1])


def _memory(basis: np.ndarray, own: np.ndarray, past: np.ndarray) -> np.ndarray:
    """Return the share of each lagged input that states add to the own taps, on unseen blocks."""
    both = np.column_stack([np.ones(len(own)), own, basis * np.sqrt(len(own))])
    blocks = np.array_split(np.arange(len(own)), _BLOCKS)
    moments = np.array([both[block].T @ np.hstack([both[block], past[block]]) for block in blocks])
    left = np.zeros((2, past.shape[1]))
    for block, of_block in zip(blocks, moments, strict=True):
        grams, targets = np.split(moments.sum(axis=0) - of_block, [both.shape[1]], axis=1)
        for row, size in enumerate((1 + own.shape[1], both.shape[1])):
            penalised = grams[:size, :size] + _ALPHA * len(own) * np.eye(size)
            weights = np.linalg.solve(penalised, targets[:size])
            left[row] += ((both[block, :size] @ weights - past[block]) ** 2).sum(axis=0)
    return (left[0] - left[1]) / np.maximum(((past - past.mean(axis=0)) ** 2).sum(axis=0), 1e-300)
