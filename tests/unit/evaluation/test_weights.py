import numpy as np
import pytest

from fprc.evaluation import split_rows
from fprc.evaluation.weights import normalised_weights
from fprc.models import FPRC
from fprc.models.fcm import fuzzy_c_means

SETTINGS = {"epsilon": 0.1, "n_c": 3, "n_u": 2, "n_y": 3, "sigma": 2.0, "alpha": 1e-3}


@pytest.fixture(scope="module")
def data(recorded):
    log = recorded["sweep"]
    X = np.column_stack([log["theta_deg"], log["p_o_kpa"]])[::5]
    return X, log["p_exp_command_kpa"][::5]


def shares(X, y, folds=3):
    model = FPRC(**SETTINGS, random_state=7)
    return normalised_weights(model, (X, y, None), split_rows(len(y), folds, "shuffled", 5))


@pytest.mark.parametrize(
    ("scale", "shift"), [((0.01, 1.0), (0.0, 0.0)), ((1.0, 1e3), (0.0, 0.0)),
                         ((1.0, 1.0), (-40.0, 101.3)), ((np.pi / 180, 1e3), (2.0, -5e4))]
)  # fmt: skip
def test_shares_do_not_depend_on_unit_or_zero_of_the_signals(data, scale, shift):
    X, y = data
    np.testing.assert_allclose(shares(X * scale + shift, y), shares(X, y), rtol=1e-3)


def test_shares_do_not_depend_on_the_sign_of_the_pressure(data):
    X, y = data
    np.testing.assert_allclose(shares(X, -y), shares(X, y), rtol=1e-6)


def by_hand(X, y, folds):
    """Shares of the best fold, from the equations of Sec. III-B and III-D."""
    n_y, n_u, epsilon = SETTINGS["n_y"], SETTINGS["n_u"], SETTINGS["epsilon"]
    theta = (X[:, 0] - X[:, 0].min()) / np.ptp(X[:, 0])
    filtered = [X[0, 1]]
    for p_o in X[1:, 1]:
        filtered.append(epsilon * p_o + (1.0 - epsilon) * filtered[-1])
    p_o = (np.array(filtered) - min(filtered)) / (max(filtered) - min(filtered))
    rows = np.array(
        [
            [1.0]
            + [theta[max(k - i, 0)] for i in range(n_y)]
            + [p_o[max(k - i, 0)] for i in range(n_u)]
            for k in range(len(X))
        ]
    )
    best = (np.inf, None)
    for i, (train, validation) in enumerate(folds):
        own = int(np.random.SeedSequence([7, i]).generate_state(1)[0])
        rng = np.random.RandomState(own)
        clusters = fuzzy_c_means(rows[train, 1:], SETTINGS["n_c"], random_state=rng)
        W_out = []
        for u in clusters.memberships.T:
            x = rows[train]
            gram = x.T @ np.diag(u**2) @ x + SETTINGS["alpha"] * np.eye(x.shape[1])
            W_out.append(np.linalg.solve(gram, x.T @ (u**2 * y[train])))
        W_out = np.array(W_out)
        errors = []
        for part in (train, validation):
            away = ((rows[part, None, 1:] - clusters.centers) ** 2).sum(axis=2)
            beta = np.exp(-away / (2.0 * SETTINGS["sigma"] ** 2))
            output = (beta * (rows[part] @ W_out.T)).sum(axis=1) / beta.sum(axis=1)
            errors.append(np.sqrt(np.mean((y[part] - output) ** 2)))
        total = np.hypot(*errors)
        if total < best[0]:
            best = (total, np.abs(W_out))
    return best[1] / best[1].sum(axis=1)[:, None]


def test_shares_are_those_of_the_equations(data):
    X, y = (values[:400] for values in data)
    folds = split_rows(400, 3, "shuffled", 5)
    np.testing.assert_allclose(shares(X, y), by_hand(X, y, folds), rtol=1e-6)
