import re
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from sklearn.base import clone
from sklearn.ensemble import ExtraTreesRegressor, HistGradientBoostingRegressor
from sklearn.neural_network import MLPRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from fprc.models import (
    ESN,
    FPRC,
    EchoStates,
    FeatureModel,
    LowpassBank,
    RidgeReadout,
    SideBySide,
    TakagiSugenoReadout,
    TapFeatures,
)

BANK = SideBySide([(TapFeatures(3), [0, 1]), (LowpassBank((0.3, 0.1)), [0])])
NETWORK = make_pipeline(
    StandardScaler(), MLPRegressor(hidden_layer_sizes=(4,), solver="lbfgs", tol=1.0)
)
REGRESSORS = [ExtraTreesRegressor(5), HistGradientBoostingRegressor(max_iter=5), NETWORK]


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        (FeatureModel(TapFeatures(), TakagiSugenoReadout()), FPRC()),
        (FeatureModel(EchoStates(r=10), RidgeReadout()), ESN(r=10)),
    ],
    ids=["fprc", "esn"],
)
def test_model_of_a_papers_parts_is_the_papers_model(ours, theirs):
    X, y = log()
    ours, theirs = (model.set_params(random_state=3).fit(X, y) for model in (ours, theirs))
    assert np.array_equal(ours.predict(X), theirs.predict(X))


@pytest.mark.parametrize("regressor", REGRESSORS)
def test_regressor_of_scikit_learn_gets_the_rows_of_the_map(regressor):
    X, y = log()
    model = FeatureModel(BANK, regressor, random_state=2).fit(X, y)
    own = clone(regressor)
    own.set_params(**{key: 2 for key in own.get_params() if key.endswith("random_state")})
    rows = clone(BANK).fit_transform(X)
    expected = own.fit(rows, y).predict(rows)
    assert np.array_equal(model.predict(X), expected)
    assert_allclose([model.step(x) for x in X[:20]], expected[:20], rtol=1e-9)


def test_seed_reaches_every_random_part_and_none_leaves_them():
    features = EchoStates(r=3, random_state=7)
    model = FeatureModel(features, NETWORK, random_state=5)
    assert model.make_features().get_params()["random_state"] == 5
    assert model.make_readout().get_params()["mlpregressor__random_state"] == 5
    kept = model.set_params(random_state=None).make_features()
    assert kept.get_params()["random_state"] == 7
    assert features.get_params()["random_state"] == 7


def test_model_of_the_documentation_learns_and_steps():
    page = Path(__file__).parents[3] / "docs/extending.md"
    blocks = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    found: dict = {}
    exec(next(block for block in blocks if "FeatureModel(" in block), found)
    X, y = log()
    model = found["model"].fit(X, y)
    assert model.readout_.w_out_.size == 1 + 10 + 3
    assert_allclose([model.step(x) for x in X], model.predict(X), rtol=0, atol=1e-9)


def log():
    time = np.arange(150) / 10.0
    theta = 20.0 + 15.0 * np.sin(time)
    X = np.column_stack([theta, 100.0 + 0.3 * theta + 2.0 * np.sin(time - 0.5)])
    return X, 175.0 + 120.0 * np.sin(time + 0.2)
