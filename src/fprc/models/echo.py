"""States of an echo state network over a whole log, many segments of it at a time."""

import numpy as np

#: Samples of a segment: twice what the paper's network takes to forget where it began.
LENGTH = 600

#: Trajectories that are nearer than this many roundings have met; states lie within [-1, 1].
MET = 64


def echo_states(
    X: np.ndarray, w_in: np.ndarray, W_r: np.ndarray, gamma: float, free: int = 0
) -> np.ndarray:
    """Return x(k) of Eq. (3) for each sample, x(0) being 0.

    A step alone has to fetch all of W_r from memory, and waits for it. The log
    is therefore cut into segments that run side by side, a step of all of them
    being one product of matrices. All but the first begin at a wrong state; they
    run again from where their predecessor ended, until they meet what they
    gave before: an echo state network forgets where it began. One that does
    not forget within a segment is run sample by sample.

    Parameters
    ----------
    X : ndarray of shape (n_samples, n_inputs)
    w_in : ndarray of shape (r, n_inputs)
    W_r : ndarray of shape (r, r)
        Its type, float64 or float32, is that of the arithmetic.
    free : int, default=0
        Columns before the states, which are left for the caller to fill.

    Returns
    -------
    ndarray of shape (n_samples, free + r)
    """
    columns = free + len(W_r)
    segments = -(-len(X) // LENGTH)
    if segments > 1:
        held = np.pad(X, ((0, segments * LENGTH - len(X)), (0, 0)), mode="edge")
        inputs = held.reshape(segments, LENGTH, -1)
        rows = np.empty((segments, LENGTH, columns), W_r.dtype)
        states = rows[:, :, free:]
        begin = np.zeros((segments, len(W_r)), W_r.dtype)
        ends, _ = _run(inputs, begin, w_in, W_r, gamma, states)
        begin[1:] = ends[:-1]
        _, met = _run(inputs, begin, w_in, W_r, gamma, states, until_met=True)
        if met:
            return rows.reshape(-1, columns)[: len(X)]
    rows = np.empty((1, len(X), columns), W_r.dtype)
    _run(X[None], np.zeros((1, len(W_r)), W_r.dtype), w_in, W_r, gamma, rows[:, :, free:])
    return rows[0]


def _run(
    inputs: np.ndarray,
    x: np.ndarray,
    w_in: np.ndarray,
    W_r: np.ndarray,
    gamma: float,
    states: np.ndarray,
    until_met: bool = False,
) -> tuple[np.ndarray, bool]:
    """Write the states of every segment, a row of ``x`` each; return where they ended.

    With ``until_met`` stop where they are what ``states`` held before, and say so.
    """
    met = MET * np.finfo(W_r.dtype).eps
    for k in range(inputs.shape[1]):
        if until_met and np.abs(states[:, k] - x).max() < met:
            return x, True
        states[:, k] = x
        target = x @ W_r.T
        target += inputs[:, k] @ w_in.T
        np.tanh(target, out=target)
        target *= 1.0 - gamma
        x = gamma * x
        x += target
    return x, False
