"""Compiled inner loops of the models.

For the few numbers of one step, NumPy's call overhead dominates. For many rows,
NumPy writes and reads temporary arrays that a compiled loop does not need.
"""

import math

import numpy as np

from fprc.compiled import kernel, summing_kernel

#: Samples per block: its intermediate results stay in the processor's cache.
BLOCK = 512


#: Kinds of features: see ``advance``.
TAP, LOWPASS, PLAY = range(3)


@kernel
def advance(row, x, columns, kinds, numbers):
    """Move the features in ``row`` on by the sample ``x``, in place.

    Parameters
    ----------
    row : ndarray of shape (n_features,)
    columns : ndarray of shape (n_features,)
        Input u of each feature.
    kinds : ndarray of shape (n_features,)
        ``TAP``: what the feature before it was at the last sample. ``LOWPASS``: p + epsilon (u - p)
        (Eq. 6). ``PLAY``: max(u - r, min(u + r, p)), which is u itself if r is 0.
    numbers : ndarray of shape (n_features,)
        epsilon of a low-pass, half-width r of a play.
    """
    for j in range(row.size - 1, -1, -1):
        u, p, number = x[columns[j]], row[j], numbers[j]
        if kinds[j] == TAP:
            row[j] = row[j - 1]
        elif kinds[j] == LOWPASS:
            row[j] = p + number * (u - p)
        else:
            row[j] = max(u - number, min(u + number, p))


@kernel
def advance_log(X, columns, kinds, numbers):
    """Return the features of every sample of a log, exactly as by ``advance``.

    Returns
    -------
    ndarray of shape (n_samples, n_features)
    """
    row = X[0][columns]
    rows = np.empty((len(X), row.size))
    for k in range(len(X)):
        advance(row, X[k], columns, kinds, numbers)
        rows[k] = row
    return rows


@kernel
def blend(x, centers, W_out, sigma):
    """Return beta_bar W_out [1, x] of one row of features (Eqs. 10-12).

    The largest exponent is subtracted first, as in ``gaussian_memberships``. Features and readout
    may not belong together, so their sizes are compared: compiled code does not check bounds.
    """
    if x.size != centers.shape[1] or W_out.shape != (len(centers), 1 + x.size):
        raise ValueError("the readout was trained on another number of features")
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


@summing_kernel
def excite(W_r, x, w_in, u, target, gamma, downwards):
    """Move ``x`` towards ``target`` in place, then set ``target`` to w_in u + W_r x.

    Four rows of W_r at a time share each read of x. ``W_r`` may be float32; the
    arithmetic has the dtype of ``x``.
    """
    for i in range(len(x)):
        x[i] = gamma * x[i] + (1.0 - gamma) * target[i]
    last, way = len(x) - 1, 1 if downwards else -1
    first = 0 if downwards else last
    for i in range(0, len(x), 4):
        a = first + way * i
        b = first + way * min(i + 1, last)
        c = first + way * min(i + 2, last)
        d = first + way * min(i + 3, last)
        p = q = r = s = x.dtype.type(0.0)
        for k in range(len(x)):
            p += W_r[a, k] * x[k]
            q += W_r[b, k] * x[k]
            r += W_r[c, k] * x[k]
            s += W_r[d, k] * x[k]
        target[a], target[b], target[c], target[d] = p, q, r, s
    for k in range(u.size):
        for i in range(len(x)):
            target[i] += w_in[i, k] * u[k]


@summing_kernel
def excite_lanes(W_r, x, w_in, u, target, gamma):
    """Apply ``excite`` to four lanes, each a row of ``x``, ``u`` and ``target``.

    Four rows of W_r times four lanes are sixteen sums; each number read is used in four of them.
    """
    size = x.shape[1]
    last = size - 1
    for lane in range(4):
        for i in range(size):
            x[lane, i] = gamma * x[lane, i] + (1.0 - gamma) * target[lane, i]
    for i in range(0, size, 4):
        a, b, c, d = i, min(i + 1, last), min(i + 2, last), min(i + 3, last)
        a0 = a1 = a2 = a3 = b0 = b1 = b2 = b3 = x.dtype.type(0.0)
        c0 = c1 = c2 = c3 = d0 = d1 = d2 = d3 = x.dtype.type(0.0)
        for k in range(size):
            p, q, r, s = W_r[a, k], W_r[b, k], W_r[c, k], W_r[d, k]
            v = x[0, k]
            a0, b0, c0, d0 = a0 + p * v, b0 + q * v, c0 + r * v, d0 + s * v
            v = x[1, k]
            a1, b1, c1, d1 = a1 + p * v, b1 + q * v, c1 + r * v, d1 + s * v
            v = x[2, k]
            a2, b2, c2, d2 = a2 + p * v, b2 + q * v, c2 + r * v, d2 + s * v
            v = x[3, k]
            a3, b3, c3, d3 = a3 + p * v, b3 + q * v, c3 + r * v, d3 + s * v
        target[0, a], target[1, a], target[2, a], target[3, a] = a0, a1, a2, a3
        target[0, b], target[1, b], target[2, b], target[3, b] = b0, b1, b2, b3
        target[0, c], target[1, c], target[2, c], target[3, c] = c0, c1, c2, c3
        target[0, d], target[1, d], target[2, d], target[3, d] = d0, d1, d2, d3
    for lane in range(4):
        for k in range(u.shape[1]):
            for i in range(size):
                target[lane, i] += w_in[i, k] * u[lane, k]


@summing_kernel
def alternate(columns, centers, before, memberships, floor):
    """Compute the memberships of ``centers``, then new centres: one iteration of fuzzy c-means.

    Parameters
    ----------
    columns : ndarray of shape (n_features, n_samples)
    centers : ndarray of shape (n_clusters, n_features)
    before, memberships : ndarray of shape (n_clusters, n_samples)
        Memberships of the last iteration, and an array that this one overwrites.
    floor : float
        Least squared distance of a sample from a centre.

    Returns
    -------
    tuple of (float, float, ndarray)
        Objective at ``centers``, largest change of a membership from ``before``,
        and the new centres.
    """
    n_samples, n_clusters = columns.shape[1], len(centers)
    closeness, total = np.empty((n_clusters, BLOCK)), np.empty(BLOCK)
    weights, sums = np.zeros(n_clusters), np.zeros(centers.shape)
    objective = change = 0.0
    for start in range(0, n_samples, BLOCK):
        block = slice(start, min(start + BLOCK, n_samples))
        size = block.stop - start
        total[:] = 0.0
        for i in range(n_clusters):
            near = closeness[i]
            near[:] = 0.0
            for j in range(len(columns)):
                x = columns[j, block]
                for k in range(size):
                    away = x[k] - centers[i, j]
                    near[k] += away * away
            for k in range(size):
                near[k] = 1.0 / max(near[k], floor)
                total[k] += near[k]
        for k in range(size):
            total[k] = 1.0 / total[k]
            objective += total[k]
        for i in range(n_clusters):
            share, old, new = closeness[i], before[i, block], memberships[i, block]
            most = weight = 0.0
            for k in range(size):
                new[k] = share[k] * total[k]
                most = max(most, abs(new[k] - old[k]))
                share[k] = new[k] * new[k]
                weight += share[k]
            change = max(change, most)
            weights[i] += weight
            for j in range(len(columns)):
                x = columns[j, block]
                moment = 0.0
                for k in range(size):
                    moment += share[k] * x[k]
                sums[i, j] += moment
    return objective, change, sums / weights.reshape(-1, 1)
