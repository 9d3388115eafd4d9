"""Models of any parts, among them those of docs/extending.md."""

import re
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from sklearn import config_context
from sklearn.base import clone
from sklearn.compose import ColumnTransformer
from sklearn.ensemble import ExtraTreesRegressor, HistGradientBoostingRegressor
from sklearn.linear_model import Ridge
from sklearn.neural_network import MLPRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from fprc.errors import FprcError
from fprc.models import (
    ESN,
    FPRC,
    NVAR,
    EchoStates,
    FeatureModel,
    LowpassBank,
    NodeFeatures,
    PlayOperators,
    RidgeReadout,
    SideBySide,
    TakagiSugenoReadout,
    TapFeatures,
    load_model,
    save_model,
)
from fprc.models.c_header import c_header

PAGE = Path(__file__).parents[3] / "docs/extending.md"
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
    assert model.set_params(random_state=None).make_features().random_state == 7
    assert features.random_state == 7


PARTS = [
    (TapFeatures(n_y=2, n_references=None), [0]),
    (PlayOperators(n_plays=3), [1, 0]),
    (LowpassBank((1.0, 0.2)), range(2)),
    (NVAR(n_taps=2, spacing=4), np.array([1])),
    (EchoStates(r=5, random_state=0), [1, 0]),
]


def test_features_are_those_of_each_map_side_by_side():
    (X, _), other = log(), log()[0][::-1]
    expected = np.hstack(
        [
            clone(features).fit(X[:, columns]).transform(other[:, columns])
            for features, columns in PARTS
        ]
    )
    features = SideBySide(PARTS).fit(X)
    assert np.array_equal(features.transform(other), expected)
    assert_allclose([features.step(x) for x in other], expected, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize(
    "maps",
    [[(TapFeatures(), [])], [(TapFeatures(), [0, 3])], [(TapFeatures(), [-1])],
     [(TapFeatures(), [True])], [(RidgeReadout(), [0])], [TapFeatures()], 3],
)  # fmt: skip
def test_maps_that_do_not_fit_are_refused(maps):
    with pytest.raises((ValueError, TypeError)):
        SideBySide(maps).fit(log()[0])


@pytest.mark.parametrize("part", [part for part, _ in PARTS] + [BANK], ids=str)
def test_features_have_names(part):
    X = pd.DataFrame(log()[0], columns=["theta", "p_o"])
    whole = clone(part).fit(X)
    names = whole.get_feature_names_out()
    assert len(set(names)) == whole.transform(X).shape[1]
    frame = clone(part).set_output(transform="pandas").fit_transform(X)
    assert list(frame.columns) == list(names)
    chosen = ColumnTransformer([("a", clone(part), ["theta", "p_o"])]).set_output(
        transform="pandas"
    )
    assert len(chosen.fit_transform(X).columns) == len(names)
    pipe = make_pipeline(clone(part), Ridge()).set_output(transform="pandas")
    assert list(pipe.fit(X, X["theta"])[:-1].get_feature_names_out()) == list(names)


def test_model_is_the_same_where_scikit_learn_gives_frames():
    X, y = log()
    expected = FPRC(n_c=2, random_state=1).fit(X, y)
    with config_context(transform_output="pandas"):
        model = FPRC(n_c=2, random_state=1).fit(X, y)
        assert model.step(X[0]) == expected.step(X[0])
        np.testing.assert_array_equal(model.predict(X), expected.predict(X))


# --- those of docs/extending.md -----------------------------------------------------------------


def of_page(name, module):
    """Run the page's block that has a text, and return its names."""
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    exec(next(block for block in blocks if name in block), vars(module))
    return module


def test_model_of_the_page_learns_and_steps():
    X, y = log()
    model = of_page("FeatureModel(", ModuleType("mine")).model.fit(X, y)
    assert_allclose([model.step(x) for x in X], model.predict(X), rtol=0, atol=1e-9)


@pytest.fixture
def ring(monkeypatch):
    module = ModuleType("my_ring")
    monkeypatch.setitem(sys.modules, "my_ring", module)
    return of_page("class Ring(", module)


class Integrator:
    """A node as ReservoirPy has them: a leaky sum of its inputs."""

    state = 0.0

    def run(self, X):
        rows = []
        for x in X:
            self.state = 0.9 * self.state + x.sum()
            rows.append([self.state])
        return np.array(rows)

    def reset(self):
        self.state = 0.0


@pytest.mark.parametrize("node", [None, Integrator])
def test_map_from_outside_is_the_same_in_a_log_and_sample_by_sample(ring, node):
    X, _ = log()
    found = (NodeFeatures(node()) if node else ring.Ring(units=20)).fit(X)
    found.reset(X[0])
    stream = [found.step(x) for x in X[:60]]
    whole = found.transform(X)  # in the middle of a stream
    stream += [found.step(x) for x in X[60:]]
    assert_allclose(stream, whole, rtol=1e-12)
    parts = found.transform(np.vstack([X, X]), lengths=[len(X)] * 2)
    np.testing.assert_array_equal(parts[len(X) :], whole)


def test_reservoir_of_the_page_is_fitted_saved_and_loaded(ring, tmp_path):
    X, y = log()
    model = ring.RingModel(units=20).fit(X, y)
    save_model(model, tmp_path / "ring.h5", [ring.RingModel])
    loaded = load_model(tmp_path / "ring.h5", [ring.RingModel])
    np.testing.assert_array_equal(loaded.predict(X), model.predict(X))
    with pytest.raises(FprcError, match="cannot be exported"):
        c_header(loaded, "ring")


def log():
    time = np.arange(150) / 10.0
    theta = 20.0 + 15.0 * np.sin(time)
    X = np.column_stack([theta, 100.0 + 0.3 * theta + 2.0 * np.sin(time - 0.5)])
    return X, 175.0 + 120.0 * np.sin(time + 0.2)
