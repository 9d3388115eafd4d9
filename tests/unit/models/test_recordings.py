import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from sklearn.base import clone
from sklearn.model_selection import GridSearchCV, KFold, cross_val_score

from fprc.models import ESN, FPRC, FuzzyLinear
from fprc.models.recordings import transform_each

MODELS = {
    "esn": ESN(r=12, washout=30, random_state=1),
    "fprc": FPRC(n_c=3, random_state=1),
    "fuzzy_linear": FuzzyLinear(n_c=3, random_state=1),
}
LENGTHS = [60, 7, 90]


@pytest.fixture(params=MODELS)
def model(request):
    return clone(MODELS[request.param])


@pytest.fixture
def recordings(model):
    """Inputs and outputs of three recordings that begin far apart."""
    rng = np.random.default_rng(3)
    columns = 2 if isinstance(model, FPRC) else 1
    X = [
        start + np.cumsum(rng.normal(size=(length, columns)), axis=0)
        for start, length in zip((0.0, 40.0, -30.0), LENGTHS, strict=True)
    ]
    return X, [2.0 * x[:, 0] + np.roll(x[:, -1], 1) for x in X]


def test_training_equals_that_on_stacked_features_computed_apart(model, recordings):
    X, y = recordings
    stacked = np.vstack([clone(model).make_features().fit(X[0]).transform(x) for x in X])
    readout = model.make_readout().fit(stacked, np.concatenate(y))
    model.fit(X, y)
    assert learned(model.readout_).keys() == learned(readout).keys()
    for name, value in learned(readout).items():
        assert np.array_equal(learned(model.readout_)[name], value), name


def test_list_of_recordings_gives_a_list_of_outputs(model, recordings):
    X, y = recordings
    listed = model.fit(X, y).predict(X)
    for output, x in zip(listed, X, strict=True):
        assert_allclose(output, model.predict(x), rtol=1e-12)


@settings(max_examples=20, deadline=None)
@given(st.lists(st.integers(5, 20), min_size=1, max_size=5), st.sampled_from(sorted(MODELS)))
def test_features_equal_a_stream_that_is_reset_at_each_recording(lengths, name):
    X = 30.0 * np.random.default_rng(sum(lengths)).normal(size=(sum(lengths), 2))
    features = clone(MODELS[name]).make_features().fit(X)
    starts = np.cumsum([0, *lengths])
    stepped = []
    for k, x in enumerate(X):
        if k in starts:
            features.reset()
        stepped.append(features.step(x))
    assert_allclose(transform_each(features, X, lengths), stepped, rtol=0, atol=1e-9)


def test_splitters_of_scikit_learn_keep_recordings_whole():
    model = MODELS["fuzzy_linear"]
    X = [30.0 * np.sin(np.arange(n)[:, None] / 9.0) for n in (40, 50, 60, 70)]
    y = [np.roll(x[:, 0], 2) for x in X]
    expected = []
    for left_out in range(4):
        rest = [i for i in range(4) if i != left_out]
        fitted = clone(model).fit([X[i] for i in rest], [y[i] for i in rest])
        expected.append(fitted.score(X[left_out], y[left_out]))
    assert cross_val_score(model, X, y, cv=KFold(4)).tolist() == expected
    search = GridSearchCV(model, {"n_y": [1, 4]}, cv=KFold(4)).fit(X, y)
    assert search.cv_results_["mean_test_score"].shape == (2,)
    assert len(search.predict(X)) == 4


def with_nan(x):
    return np.where(np.arange(len(x))[:, None] == 4, np.nan, x)


#: What is given to ``fit`` for three recordings, and the message.
WRONG = [
    (lambda X, y: (X, y[:2]), "X has 3 recordings; y must be a list"),
    (lambda X, y: (X, np.concatenate(y)), "X has 3 recordings; y must be a list"),
    (lambda X, y: (X, [1.0, 2.0, 3.0]), "X has 3 recordings; y must be a list"),
    (lambda X, y: ([*X[:2], with_nan(X[2])], y), "recording 3 of 3: X .* sample 4;"),
    (lambda X, y: (X, [y[0], y[1] + np.inf, y[2]]), "recording 2 of 3: y .* sample 0;"),
    (lambda X, y: (X, [y[0], y[1][:-1], y[2]]), "X has 3 recordings; y must be a list"),
    (lambda X, y: ([X[0], X[1][:3], X[2]], [y[0], y[1][:3], y[2]]), "2 of 3: n_samples = 3 is"),
    (lambda X, y: ([X[0], np.ones((7, 3)), X[2]], y), "must match exactly"),
]


@pytest.mark.parametrize(("wrong", "problem"), WRONG)
def test_recordings_that_do_not_go_together_are_refused(wrong, problem, model, recordings):
    with pytest.raises(ValueError, match=problem):
        model.fit(*wrong(*recordings))


def test_columns_of_tables_are_joined_by_their_names():
    X = 30.0 * np.random.default_rng(1).normal(size=(40, 2))
    table, y = pd.DataFrame(X, columns=["theta_deg", "p_o_kpa"]), [X[:, 0], X[:, 0]]
    model = clone(MODELS["fprc"]).fit([table, table[["p_o_kpa", "theta_deg"]]], y)
    assert list(model.feature_names_in_) == ["theta_deg", "p_o_kpa"]
    expected = clone(MODELS["fprc"]).fit([X, X], y).predict(X)
    assert np.array_equal(model.predict(table), expected)


def learned(estimator):
    return {name: value for name, value in vars(estimator).items() if name.endswith("_")}
