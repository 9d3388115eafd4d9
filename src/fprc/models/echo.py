"""States of an echo state network, for one sample or for a whole log."""

import numpy as np

from fprc.models.kernels import LANES, excite, excite_lanes

#: Shortest segment, samples: almost three times what the paper's network needs to forget its
#: initial state.
SHORTEST = 600

#: States, in [-1, 1], that differ by less than this count as equal.
EQUAL = 64 * np.finfo(float).eps


def echo_states(
    X: np.ndarray,
    state: np.ndarray,
    w_in: np.ndarray,
    W_r: np.ndarray,
    gamma: float,
    states: np.ndarray,
) -> None:
    """Compute x(k) of Eq. (3) for each sample.

    A step reads all of W_r and is limited by memory bandwidth. The log is therefore cut into
    segments that advance together and share each read of W_r. All but the first segment start
    from a wrong state, which an echo state network forgets: they run again, from the end state
    of their predecessor, until their states equal those of the first run. A network that does
    not forget within a segment is run sample by sample.

    Parameters
    ----------
    X : ndarray of shape (n_samples, n_inputs)
    state : ndarray of shape (2, r)
        x and tanh(w_in theta + W_r x) of the sample before, zeros before the first one; moved on,
        in place, to those of the last sample.
    w_in : ndarray of shape (r, n_inputs)
    W_r : ndarray of shape (r, r)
        As ``narrowed`` returns it.
    states : ndarray of shape (n_samples, r)
        Overwritten with x(k).
    """
    length = len(X) // LANES
    done = LANES * length
    if length < SHORTEST or not _side_by_side(
        X[:done].reshape(LANES, length, -1), state, w_in, W_r, gamma,
        states[:done].reshape(LANES, length, -1),
    ):  # fmt: skip
        done = 0
    x, target = state
    for u, row in zip(X[done:], states[done:], strict=True):
        update(x, target, u, w_in, W_r, gamma)
        row[:] = x


def update(
    x: np.ndarray, target: np.ndarray, u: np.ndarray, w_in: np.ndarray, W_r: np.ndarray,
    gamma: float,
) -> None:  # fmt: skip
    """Advance the state ``x`` by one sample with input ``u``, in place (Eq. 3).

    Parameters
    ----------
    target : ndarray of shape (r,)
        tanh(w_in theta + W_r x) of the previous sample; overwritten with this sample's. At the
        first sample it equals ``x``, so that ``x`` does not change.
    """
    excite(W_r, x, w_in, u, target, float(gamma))
    np.tanh(target, out=target)


def _side_by_side(
    inputs: np.ndarray, state: np.ndarray, w_in: np.ndarray, W_r: np.ndarray, gamma: float,
    states: np.ndarray,
) -> bool:  # fmt: skip
    """Run all segments, and again until their states are the same; return whether they became so.

    If not, ``state`` is as before.
    """
    lanes = np.zeros((2, LANES, len(W_r)))
    lanes[:, 0] = end = state
    for again in (False, True):
        x, target = lanes
        for k in range(inputs.shape[1]):
            excite_lanes(W_r, x, w_in, inputs[:, k], target, float(gamma))
            np.tanh(target, out=target)
            if again and np.abs(states[:, k] - x).max() < EQUAL:
                state[:] = end
                return True
            states[:, k] = x
        end = lanes[:, -1].copy()
        lanes[:, 1:] = lanes[:, :-1].copy()
        lanes[:, 0] = state
    return False


def narrowed(matrix: np.ndarray) -> np.ndarray:
    """Return a copy that begins at a cache line, in float32 if that changes no number.

    Memory bandwidth limits a step, and float32 has half the bytes.
    """
    single = matrix.astype(np.float32)
    chosen = single if np.array_equal(single, matrix) else matrix
    line = 64
    buffer = np.empty(chosen.nbytes + line, np.uint8)
    first = -buffer.ctypes.data % line
    copy = buffer[first : first + chosen.nbytes].view(chosen.dtype).reshape(chosen.shape)
    copy[:] = chosen
    return copy
