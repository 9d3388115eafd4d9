"""Feature maps from outside: the reservoir of docs/extending.md, and nodes of another library."""

import re
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pandas as pd
import pytest
from sklearn import config_context
from sklearn.base import clone
from sklearn.compose import ColumnTransformer
from sklearn.linear_model import Ridge
from sklearn.pipeline import make_pipeline

from fprc.errors import FprcError
from fprc.models import (
    FPRC,
    NVAR,
    EchoStates,
    FeatureModel,
    FuzzyLinear,
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


def log(samples=120):
    time = np.arange(samples) / 10.0
    return np.column_stack([20.0 + 15.0 * np.sin(time), 100.0 + 5.0 * np.sin(time - 0.5)])


@pytest.fixture
def ring(monkeypatch):
    """Return the second class of the page's block on reservoirs."""
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    (code,) = [block for block in blocks if "class Ring(" in block]
    module = ModuleType("my_ring")
    monkeypatch.setitem(sys.modules, "my_ring", module)
    exec(code, vars(module))
    return module


class Integrator:
    """A node as ReservoirPy has them: a leaky sum of its inputs, twice."""

    def __init__(self):
        self.state, self.runs = None, 0

    def run(self, X):
        self.state, rows = 0.0 if self.state is None else self.state, []
        for x in X:
            self.state = 0.9 * self.state + x.sum()
            rows.append([self.state, -self.state])
        return np.array(rows)

    def reset(self):
        self.state = 0.0


@pytest.mark.parametrize("name", ["ring", "node"])
def test_map_from_outside_is_the_same_in_a_log_and_sample_by_sample(ring, name):
    made = ring.Ring(units=20) if name == "ring" else NodeFeatures(Integrator())
    found = made.fit(log())
    found.reset(log()[0])
    stream = [found.step(x) for x in log()[:60]]
    whole = found.transform(log())  # in the middle of a stream
    stream += [found.step(x) for x in log()[60:]]
    np.testing.assert_allclose(stream, whole, rtol=1e-12)
    parts = found.transform(np.vstack([log(), log()]), lengths=[120, 120])
    np.testing.assert_array_equal(parts[120:], whole)


def test_reservoir_of_the_page_is_fitted_saved_and_loaded(ring, tmp_path):
    y = log()[:, 0] + log()[:, 1]
    model = ring.RingModel(units=20).fit(log(), y)
    save_model(model, tmp_path / "ring.h5", [ring.RingModel])
    loaded = load_model(tmp_path / "ring.h5", [ring.RingModel])
    np.testing.assert_array_equal(loaded.predict(log()), model.predict(log()))
    with pytest.raises(FprcError, match="cannot be exported"):
        c_header(loaded, "ring")


def test_model_on_a_node_is_not_saved(tmp_path):
    model = FeatureModel(NodeFeatures(Integrator(), washout=5), RidgeReadout())
    model.fit(log(), log()[:, 0])
    assert np.isfinite(clone(model).fit(log(), log()[:, 0]).predict(log())).all()
    with pytest.raises(FprcError, match="Integrator"):
        save_model(model, tmp_path / "node.h5")


def test_node_of_reservoirpy_is_a_map():
    nodes = pytest.importorskip("reservoirpy.nodes")
    made = NodeFeatures(nodes.Reservoir(12, sr=0.9, lr=0.3, seed=1)).fit(log())
    whole = made.transform(log())
    assert whole.shape == (120, 12)
    made.reset(log()[0])
    np.testing.assert_allclose([made.step(x) for x in log()], whole, rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(clone(made).fit(log()).transform(log()), whole)


MAPS = [
    TapFeatures(),
    LowpassBank(),
    NVAR(2, 3),
    PlayOperators(),
    EchoStates(r=5),
    SideBySide([(TapFeatures(n_references=None), [0])]),
    NodeFeatures(Integrator()),
]


@pytest.mark.parametrize("part", MAPS, ids=lambda part: type(part).__name__)
def test_features_have_names(part):
    X = pd.DataFrame(log(), columns=["theta", "p_o"])
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
    expected = FPRC(n_c=2, random_state=1).fit(log(), log()[:, 0])
    with config_context(transform_output="pandas"):
        model = FPRC(n_c=2, random_state=1).fit(log(), log()[:, 0])
        assert model.step(log()[0]) == expected.step(log()[0])
        np.testing.assert_array_equal(model.predict(log()), expected.predict(log()))


TARGETS = {
    "text": (str, None),
    "objects": (object, None),
    "bytes": ("S", r"S32.*convert"),
    "durations": ("m8[s]", "timedelta64"),
    "dates": ("M8[s]", "datetime64"),
}


@pytest.mark.parametrize(("kind", "problem"), TARGETS.values(), ids=TARGETS)
@pytest.mark.parametrize(
    "model", [FuzzyLinear(n_c=2, random_state=1), RidgeReadout(), TakagiSugenoReadout(n_c=2)]
)
def test_targets_are_converted_or_refused_by_name(model, kind, problem):
    y = np.round(log()[:, 0], 3)
    if problem is None:
        expected = clone(model).set_params(**seed(model)).fit(log(), y).predict(log())
        found = clone(model).set_params(**seed(model)).fit(log(), y.astype(kind))
        np.testing.assert_array_equal(found.predict(log()), expected)
    else:
        with pytest.raises(ValueError, match=problem):
            clone(model).fit(log(), y.astype(kind))


def seed(model):
    return {"random_state": 1} if "random_state" in model.get_params() else {}


@pytest.mark.parametrize("largest", [1e101, 1e155, 1e300])
def test_numbers_whose_squares_overflow_are_refused(largest):
    with pytest.raises(ValueError, match="numbers up to"):
        TakagiSugenoReadout(n_c=2).fit(log() / 100.0 * largest, log()[:, 0])
