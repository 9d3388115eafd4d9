"""States of an echo state network, for one sample or for a whole log."""

import numpy as np

from fprc.models.kernels import excite, excite_lanes

#: Segments that are computed side by side.
LANES = 4

#: Shortest segment, samples: almost three times what the paper's network needs to forget its
#: initial state.
SHORTEST = 600

#: States, in [-1, 1], that differ by less than this many machine epsilons count as equal.
EQUAL_EPS = 64


def echo_states(
    X: np.ndarray, w_in: np.ndarray, W_r: np.ndarray, gamma: float, free: int = 0
) -> np.ndarray:
    """Return x(k) of Eq. (3) for each sample, from x(0) = 0.

    A step reads all of W_r and is limited by memory bandwidth. The log is therefore cut into
    segments that advance together and share each read of W_r. All but the first segment start
    from a wrong state, which an echo state network forgets: they run again, from the end state
    of their predecessor, until their states equal those of the first run. A network that does
    not forget within a segment is run sample by sample.

    Parameters
    ----------
    X : ndarray of shape (n_samples, n_inputs)
        Its dtype, float64 or float32, is also that of the arithmetic.
    w_in : ndarray of shape (r, n_inputs)
    W_r : ndarray of shape (r, r)
    free : int, default=0
        Columns in front of the states, which the caller fills.

    Returns
    -------
    ndarray of shape (n_samples, free + r)
    """
    r, W_r = len(W_r), narrowed(W_r)
    length = -(-len(X) // LANES)
    if length >= SHORTEST:
        padded = np.pad(X, ((0, LANES * length - len(X)), (0, 0)), mode="edge")
        inputs = padded.reshape(LANES, length, -1)
        rows = np.empty((LANES, length, free + r), X.dtype)
        begin = np.zeros((LANES, r), X.dtype)
        ends, _ = _run(inputs, begin, w_in, W_r, gamma, rows[:, :, free:])
        begin[1:] = ends[:-1]
        _, converged = _run(
            inputs, begin, w_in, W_r, gamma, rows[:, :, free:], until_converged=True
        )
        if converged:
            return rows.reshape(-1, free + r)[: len(X)]
    rows = np.empty((len(X), free + r), X.dtype)
    x, target = np.zeros((2, r), X.dtype)
    for k, u in enumerate(X):
        update(x, target, u, w_in, W_r, gamma, k % 2 == 0)
        rows[k, free:] = x
    return rows


def update(
    x: np.ndarray,
    target: np.ndarray,
    u: np.ndarray,
    w_in: np.ndarray,
    W_r: np.ndarray,
    gamma: float,
    downwards: bool,
) -> None:
    """Advance the state ``x`` by one sample with input ``u``, in place (Eq. 3).

    Parameters
    ----------
    target : ndarray of shape (r,)
        tanh(w_in theta + W_r x) of the previous sample; overwritten with this sample's. At the
        first sample it equals ``x``, so that ``x`` does not change.
    downwards : bool
        Order in which the rows of W_r are read. Alternate it: the rows that were read last are
        still in the cache.
    """
    excite(W_r, x, w_in, u, target, float(gamma), downwards)
    np.tanh(target, out=target)


def _run(
    inputs: np.ndarray,
    begin: np.ndarray,
    w_in: np.ndarray,
    W_r: np.ndarray,
    gamma: float,
    states: np.ndarray,
    until_converged: bool = False,
) -> tuple[np.ndarray, bool]:
    """Run every segment from its row of ``begin``, fill ``states``, and return the end states.

    With ``until_converged``, stop at the first sample at which the states equal those already in
    ``states``; the second returned value says whether there was one.
    """
    tolerance = EQUAL_EPS * np.finfo(begin.dtype).eps
    x, target = begin.copy(), begin.copy()
    for k in range(inputs.shape[1]):
        excite_lanes(W_r, x, w_in, inputs[:, k], target, float(gamma))
        if until_converged and np.abs(states[:, k] - x).max() < tolerance:
            return x, True
        states[:, k] = x
        np.tanh(target, out=target)
    return gamma * x + (1.0 - gamma) * target, False


def narrowed(matrix: np.ndarray) -> np.ndarray:
    """Return a copy, aligned to a cache line, in float32 if that changes no number.

    Memory bandwidth limits a step, and float32 has half the bytes.
    """
    single = matrix.astype(np.float32)
    return aligned(single if np.array_equal(single, matrix) else matrix)


def aligned(matrix: np.ndarray) -> np.ndarray:
    """Return a copy that begins at a cache line."""
    line = 64
    buffer = np.empty(matrix.nbytes + line, np.uint8)
    first = -buffer.ctypes.data % line
    copy = buffer[first : first + matrix.nbytes].view(matrix.dtype).reshape(matrix.shape)
    copy[:] = matrix
    return copy
