"""Compiled inner loops of the models.

For the few numbers of one step, NumPy's call overhead dominates; for many rows, NumPy writes and
reads temporary arrays that a compiled loop does not need.
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
    """Move the features in ``row`` on by the sample ``x``, in place; u is the input of a feature.

    ``TAP``: what the feature before it was at the last sample. ``LOWPASS``: p + epsilon (u - p)
    (Eq. 6). ``PLAY``: max(u - r, min(u + r, p)), which is u itself if r is 0. ``numbers`` are
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
    """Return the features of every sample of a log, exactly as by ``advance``."""
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
    distance2 = np.zeros(len(centers))
    for i in range(len(centers)):
        for j in range(x.size):
            away = x[j] - centers[i, j]
            distance2[i] += away * away
    nearest, blended, total = distance2.min(), 0.0, 0.0
    for i in range(len(centers)):
        beta = math.exp((nearest - distance2[i]) / (2.0 * sigma * sigma))
        rule = W_out[i, 0]
        for j in range(x.size):
            rule += W_out[i, j + 1] * x[j]
        blended += beta * rule
        total += beta
    return blended / total


@summing_kernel
def excite(x, target, u, W_r, w_in, gamma):
    """Move ``x`` towards ``target`` in place, then set ``target`` to w_in u + W_r x.

    Four rows of W_r at a time share each read of x. ``W_r`` may be float32; the arithmetic is
    float64.
    """
    _leak(x, target, gamma)
    last = len(x) - 1
    for a in range(0, len(x), 4):
        b, c, d = min(a + 1, last), min(a + 2, last), min(a + 3, last)
        p = q = r = s = 0.0
        for k in range(len(x)):
            p += W_r[a, k] * x[k]
            q += W_r[b, k] * x[k]
            r += W_r[c, k] * x[k]
            s += W_r[d, k] * x[k]
        target[a], target[b], target[c], target[d] = p, q, r, s
    _drive(target, w_in, u)


#: Rows of ``x`` that ``excite_lanes`` moves together.
LANES = 4


@summing_kernel
def excite_lanes(x, target, u, W_r, w_in, gamma):
    """Apply ``excite`` to four lanes, each a row of ``x``, ``target`` and ``u``.

    Three rows of W_r times four lanes are twelve sums. With the four numbers read for them they
    fill the sixteen vector registers of AVX2, and keep the multipliers of AVX-512 busy too.
    """
    for lane in range(LANES):
        _leak(x[lane], target[lane], gamma)
    last = x.shape[1] - 1
    for a in range(0, x.shape[1], 3):
        b, c = min(a + 1, last), min(a + 2, last)
        a0 = a1 = a2 = a3 = b0 = b1 = b2 = b3 = c0 = c1 = c2 = c3 = 0.0
        for k in range(x.shape[1]):
            p, q, r = W_r[a, k], W_r[b, k], W_r[c, k]
            a0, b0, c0 = a0 + p * x[0, k], b0 + q * x[0, k], c0 + r * x[0, k]
            a1, b1, c1 = a1 + p * x[1, k], b1 + q * x[1, k], c1 + r * x[1, k]
            a2, b2, c2 = a2 + p * x[2, k], b2 + q * x[2, k], c2 + r * x[2, k]
            a3, b3, c3 = a3 + p * x[3, k], b3 + q * x[3, k], c3 + r * x[3, k]
        for i, sums in ((a, (a0, a1, a2, a3)), (b, (b0, b1, b2, b3)), (c, (c0, c1, c2, c3))):
            for lane in range(LANES):
                target[lane, i] = sums[lane]
    for lane in range(LANES):
        _drive(target[lane], w_in, u[lane])


@summing_kernel
def _leak(x, target, gamma):
    for i in range(len(x)):
        x[i] = gamma * x[i] + (1.0 - gamma) * target[i]


@summing_kernel
def _drive(target, w_in, u):
    for k in range(u.size):
        for i in range(len(target)):
            target[i] += w_in[i, k] * u[k]


@summing_kernel
def alternate(columns, centers, before, memberships, floor):
    """Compute the memberships of ``centers``, then new centres: one iteration of fuzzy c-means.

    ``columns`` are features by samples; ``before`` and ``memberships``, clusters by samples, those
    of the last iteration and an array to overwrite; ``floor`` is the least squared distance of a
    sample from a centre. Return the objective at ``centers``, the largest change of a membership
    from ``before``, and the new centres.
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
