"""The models against other libraries, and against the paper's equations as plain loops."""

import decimal
import math
from decimal import Decimal

import numpy as np
import pytest
import scipy.linalg
from numpy.testing import assert_allclose
from scipy.signal import lfilter

from fprc.models import ESN, FPRC, FuzzyLinear, RidgeReadout, TapFeatures
from fprc.models.fcm import fuzzy_c_means
from fprc.models.fprc import gaussian_memberships
from fprc.models.ridge import with_bias


def hysteresis(size):
    """Return a bending angle and a pressure that lags behind it, as loops of growing size."""
    phase = np.arange(size) * 6.0 * np.pi / size
    theta = 25.0 - (10.0 + 1.5 * phase / np.pi) * np.cos(phase)
    slow = lfilter([0.05], [1.0, -0.95], 0.4 * theta + 0.01 * theta**2)
    return np.column_stack([theta, 100.0 + slow])


def pressure(X):
    return 5.0 * X[:, 0] + 0.05 * X[:, 0] ** 2 + 2.0 * (X[:, -1] - 100.0)


def test_ridge_on_collinear_taps_predicts_as_the_augmented_system():
    X = hysteresis(800)
    rows = TapFeatures().fit_transform(X)
    extended, y = with_bias(rows), pressure(X)
    stacked = np.vstack([extended, np.sqrt(1e-3) * np.eye(extended.shape[1])])
    expected = scipy.linalg.lstsq(stacked, np.concatenate([y, np.zeros(extended.shape[1])]))[0]
    assert_allclose(RidgeReadout().fit(rows, y).predict(rows), extended @ expected, rtol=1e-6)


@pytest.mark.parametrize("distance", [0.0, 10.0, 77.0, 500.0, 1e4])
@pytest.mark.parametrize("sigma", [0.5, 2.0])
def test_memberships_equal_those_in_sixty_digits(distance, sigma):
    centers = np.random.default_rng(2).normal(scale=0.2 * sigma, size=(4, 8))
    # leave the centres at right angles to their differences, so that all stay in play
    _, _, directions = np.linalg.svd(centers[1:] - centers[0])
    X = centers.mean(axis=0) + distance * directions[-1]
    expected = exact_memberships(X, centers, sigma)
    assert min(expected) > 0.05
    got = gaussian_memberships(X[None, :], centers, sigma)[0]
    assert_allclose(got, expected, rtol=1e-6)


def exact_memberships(x, centers, sigma):
    with decimal.localcontext(prec=60, Emin=decimal.MIN_EMIN, Emax=decimal.MAX_EMAX):
        beta = [
            (
                -sum((Decimal(a) - Decimal(b)) ** 2 for a, b in zip(x, c, strict=True))
                / (2 * Decimal(sigma) ** 2)
            ).exp()
            for c in centers.tolist()
        ]
        return [float(activation / sum(beta)) for activation in beta]


def equation_3(features, X, washout):
    """Return x(k) of each sample, scalar by scalar."""
    w_in, W_r = features.w_in_.tolist(), features.W_r_.tolist()
    gamma, r = features.gamma, features.r
    x, states = [0.0] * r, []
    for k in range(-washout, len(X)):
        theta = X[max(k, 0)]
        if k >= 0:
            states.append(x)
        x = [
            gamma * x[i]
            + (1.0 - gamma)
            * math.tanh(
                sum(w_in[i][j] * theta[j] for j in range(len(theta)))
                + sum(W_r[i][j] * x[j] for j in range(r))
            )
            for i in range(r)
        ]
    return states


def test_esn_equals_equations_3_to_5():
    X, n_y, alpha = hysteresis(150)[:, :1], 4, 0.01
    y = pressure(hysteresis(150))
    model = ESN(r=6, f_input=0.05, n_y=n_y, alpha=alpha, washout=10, random_state=3).fit(X, y)
    states = equation_3(model.features_, X, washout=10)
    extended = np.array(
        [[1.0, *(X[max(k - j, 0), 0] for j in range(n_y)), *states[k]] for k in range(len(X))]
    )
    w_out = augmented(extended, y, np.ones(len(y)), alpha)
    assert_allclose(model.predict(X), extended @ w_out, rtol=1e-7)


@pytest.mark.parametrize("cls", [FPRC, FuzzyLinear])
def test_fuzzy_models_equal_equations_6_to_12(cls):
    X, y = hysteresis(200), pressure(hysteresis(200))
    settings_ = {"n_c": 4, "n_y": 3, "sigma": 3.0, "alpha": 0.01, "random_state": 2}
    filtered, before = [], X[0, 1]
    for value in X[:, 1]:
        before = 0.2 * value + 0.8 * before
        filtered.append(before)
    if cls is FPRC:
        model, n_u = FPRC(n_u=2, epsilon=0.2, **settings_).fit(X, y), 2
    else:
        X, n_u = X[:, :1], 0
        model = FuzzyLinear(**settings_).fit(X, y)
    states = [
        [*(X[max(k - j, 0), 0] for j in range(3)), *(filtered[max(k - j, 0)] for j in range(n_u))]
        for k in range(len(X))
    ]
    assert_allclose(model.predict(X), equations_6_to_12(states, y, **settings_), rtol=1e-7)


def equations_6_to_12(states, y, *, n_c, sigma, alpha, random_state, n_y):
    """Return P_ff of each training sample, rule by rule."""
    centers, u, *_ = fuzzy_c_means(np.array(states), n_c, random_state=random_state)
    extended = np.array([[1.0, *state] for state in states])
    w_out = [augmented(extended, y, u[:, i] ** 2, alpha) for i in range(n_c)]
    outputs = []
    for state in states:
        beta = [
            math.exp(-sum((a - b) ** 2 for a, b in zip(state, c, strict=True)) / (2.0 * sigma**2))
            for c in centers
        ]
        total = 0.0
        for i in range(n_c):
            rule = w_out[i][0] + sum(w * a for w, a in zip(w_out[i][1:], state, strict=True))
            total += beta[i] / sum(beta) * rule
        outputs.append(total)
    return outputs


def augmented(extended, y, weight, alpha):
    """Return the ridge solution by least squares, which needs no normal equations."""
    root, size = np.sqrt(weight), extended.shape[1]
    stacked = np.vstack([root[:, None] * extended, np.sqrt(alpha) * np.eye(size)])
    return scipy.linalg.lstsq(stacked, np.concatenate([root * y, np.zeros(size)]))[0]
