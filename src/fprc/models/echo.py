"""States of an echo state network: a step, and a whole log, four segments of it at a time."""

import numpy as np

from fprc.models.kernels import excite, excite_lanes

#: Segments that run side by side.
LANES = 4

#: Samples of a segment at least: almost three times what the paper's network takes to forget where
#: it began.
SHORTEST = 600

#: Trajectories that are nearer than this many roundings have met; states lie within [-1, 1].
MET = 64


def echo_states(
    X: np.ndarray, w_in: np.ndarray, W_r: np.ndarray, gamma: float, free: int = 0
) -> np.ndarray:
    """Return x(k) of Eq. (3) for each sample, x(0) being 0.

    A step alone has to fetch all of W_r from memory, and waits for it. The log
    is therefore cut into segments that run side by side, so that one fetch
    serves them all. All but the first begin at a wrong state; they run again
    from where their predecessor ended, until they meet what they gave before:
    an echo state network forgets where it began. One that does not forget
    within a segment is run sample by sample.

    Parameters
    ----------
    X : ndarray of shape (n_samples, n_inputs)
        Its type, float64 or float32, is that of the arithmetic.
    w_in : ndarray of shape (r, n_inputs)
    W_r : ndarray of shape (r, r)
    free : int, default=0
        Columns before the states, which are left for the caller to fill.

    Returns
    -------
    ndarray of shape (n_samples, free + r)
    """
    r, W_r = len(W_r), narrowed(W_r)
    length = -(-len(X) // LANES)
    if length >= SHORTEST:
        held = np.pad(X, ((0, LANES * length - len(X)), (0, 0)), mode="edge")
        inputs = held.reshape(LANES, length, -1)
        rows = np.empty((LANES, length, free + r), X.dtype)
        begin = np.zeros((LANES, r), X.dtype)
        ends, _ = _run(inputs, begin, w_in, W_r, gamma, rows[:, :, free:])
        begin[1:] = ends[:-1]
        _, met = _run(inputs, begin, w_in, W_r, gamma, rows[:, :, free:], until_met=True)
        if met:
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
    """Move the state ``x`` to the sample of input ``u``, in place (Eq. 3).

    Parameters
    ----------
    target : ndarray of shape (r,)
        tanh(w_in theta + W_r x) of the sample before, in place that of this one; to begin
        with the state, which then stays.
    downwards : bool
        Where to begin in W_r; who alternates finds there what the cache still holds.
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
    until_met: bool = False,
) -> tuple[np.ndarray, bool]:
    """Write the states of every segment, a row of ``begin`` each; return where they ended.

    With ``until_met`` stop where they are what ``states`` held before, and say so.
    """
    met = MET * np.finfo(begin.dtype).eps
    x, target = begin.copy(), begin.copy()
    for k in range(inputs.shape[1]):
        excite_lanes(W_r, x, w_in, inputs[:, k], target, float(gamma))
        if until_met and np.abs(states[:, k] - x).max() < met:
            return x, True
        states[:, k] = x
        np.tanh(target, out=target)
    return gamma * x + (1.0 - gamma) * target, False


def narrowed(matrix: np.ndarray) -> np.ndarray:
    """Return the same numbers in half the bytes if float32 has them, from a cache line on.

    A step is bound by memory.
    """
    halved = matrix.astype(np.float32)
    return aligned(halved if np.array_equal(halved, matrix) else matrix)


def aligned(matrix: np.ndarray) -> np.ndarray:
    """Copy to where a cache line begins."""
    line = 64
    room = np.empty(matrix.nbytes + line, np.uint8)
    first = -room.ctypes.data % line
    copy = room[first : first + matrix.nbytes].view(matrix.dtype).reshape(matrix.shape)
    copy[:] = matrix
    return copy
