"""A step of the fuzzy models, compiled: on so few numbers NumPy is mostly calls."""

import math

from fprc.compiled import kernel


@kernel
def shift(row, first, filtered, x, references, epsilon):
    """Move the taps in ``row`` on by the sample ``x``, which a readout's filter sees first.

    Parameters
    ----------
    row : ndarray of shape (n_features,)
        The taps of every column, changed in place.
    first : ndarray of shape (n_inputs,)
        Where the taps of each column begin.
    filtered : ndarray of shape (n_inputs,)
        State of the filters, changed in place.
    references : int
        Leading columns, which are not filtered.
    """
    for j in range(row.size - 1, 0, -1):
        row[j] = row[j - 1]
    for j in range(x.size):
        change = x[j] - filtered[j]
        filtered[j] = x[j] if j < references else filtered[j] + epsilon * change
        row[first[j]] = filtered[j]


@kernel
def blend(x, centers, W_out, sigma):
    """Return beta_bar W_out [1, x] of one row of features (Eqs. 9, 10, 12).

    The largest exponent is subtracted first, as in ``gaussian_memberships``.
    """
    nearest = math.inf
    for i in range(len(centers)):
        nearest = min(nearest, _distance2(x, centers[i]))
    blended = total = 0.0
    for i in range(len(centers)):
        beta = math.exp((nearest - _distance2(x, centers[i])) / (2.0 * sigma * sigma))
        rule = W_out[i, 0]
        for j in range(x.size):
            rule += W_out[i, j + 1] * x[j]
        blended += beta * rule
        total += beta
    return blended / total


@kernel
def _distance2(x, center):
    distance2 = 0.0
    for j in range(x.size):
        away = x[j] - center[j]
        distance2 += away * away
    return distance2
