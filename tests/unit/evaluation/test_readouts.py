"""Readouts by sums of moments, against fits of the selected rows."""

import numpy as np
import pytest
from sklearn.linear_model import Ridge

from fprc.config import Settings
from fprc.evaluation.sides import ALPHAS, BlockReadouts, Recordings, models_at
from fprc.models import RidgeReadout
from fprc.models.fcm import fuzzy_c_means
from fprc.models.fprc import gaussian_memberships
from fprc.registry import build

MODELS = Settings().model_dump(mode="json")["models"]
OWN = models_at(MODELS, 50.0 / 200.0)
LENGTHS = [2400, 1600]
FOLDS = Recordings(*np.zeros((3, 4000)), LENGTHS, 50.0).folds()


@pytest.fixture
def log(seen):
    channels = seen["sweep"]
    names = ("theta_deg", "p_o_kpa", "p_target_kpa")
    return Recordings(*(channels[name] for name in names), LENGTHS, 50.0)


def training(*blocks):
    """Return the rows that train if some blocks are out."""
    rows = set(FOLDS[blocks[0]][0])
    return np.array(sorted(rows.intersection(*(FOLDS[block][0] for block in blocks))))


def rmse(output, wanted, low, high):
    return float(np.sqrt(np.mean((np.clip(output, low, high) - wanted) ** 2)))


@pytest.mark.parametrize("out", [(3,), (3, 4), (5, 0), (6, 5, 9)])
def test_errors_are_those_of_fits_without_the_blocks(log, out):
    X, y = np.column_stack([log.theta, log.p_o]), log.target
    model = build("ridge_p_o", OWN, 1)
    rows = model.make_features().fit(X).transform(X, LENGTHS)
    train, block = training(*out), FOLDS[out[0]][1]
    ends = y[train].min(), y[train].max()

    own = BlockReadouts(log, "ridge_p_o", MODELS, 1, as_is=True).errors(out[0], out[1:])
    fitted = RidgeReadout(MODELS["alpha"]).fit(rows[train], y[train])
    expected = rmse(fitted.predict(rows[block]), y[block], *ends)
    assert own == pytest.approx([expected], rel=1e-6)

    scaled = (rows - rows.mean(axis=0)) / rows.std(axis=0)
    found = BlockReadouts(log, "ridge_p_o", MODELS, 1).errors(out[0], out[1:])
    for alpha, error in zip(ALPHAS, found, strict=True):
        ridge = Ridge(alpha * len(train)).fit(scaled[train], y[train])
        expected = rmse(ridge.predict(scaled[block]), y[block], *ends)
        assert error == pytest.approx(expected, rel=1e-4)


def test_fuzzy_readout_is_fitted_rule_by_rule_around_common_centres(log):
    X, y = np.column_stack([log.theta, log.p_o]), log.target
    model = build("fprc", OWN, 1)
    rows = model.make_features().fit(X).transform(X, LENGTHS)
    readout = model.make_readout()
    clusters = fuzzy_c_means(rows, readout.n_c, random_state=1, restarts=readout.restarts)
    train, block = training(2), FOLDS[2][1]
    extended = np.column_stack([np.ones(len(rows)), rows])
    output = np.zeros(len(block))
    beta = gaussian_memberships(rows[block], clusters.centers, readout.sigma)
    for i, u in enumerate(clusters.memberships[train].T):
        weighted = extended[train] * u[:, None]
        penalty = np.sqrt(readout.alpha) * np.eye(weighted.shape[1])
        fitted = np.linalg.lstsq(
            np.vstack([weighted, penalty]), np.append(y[train] * u, np.zeros(len(penalty)))
        )[0]
        output += beta[:, i] * (extended[block] @ fitted)
    expected = rmse(output, y[block], y[train].min(), y[train].max())
    found = BlockReadouts(log, "fprc", MODELS, 1, as_is=True).errors(2)
    assert found == pytest.approx([expected], rel=1e-5)
