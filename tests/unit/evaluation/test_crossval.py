import numpy as np
import pytest
from numpy.testing import assert_allclose
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.pipeline import make_pipeline

from fprc.errors import EvaluationError
from fprc.evaluation import crossval, evaluate, prepare, rmse, split_rows
from fprc.evaluation.folds import split_blocks
from fprc.models import ESN, FPRC, FuzzyLinear, SequenceModel, TakagiSugenoReadout, TapFeatures

MODELS = [
    ESN(r=10, random_state=1),
    FPRC(n_c=2, random_state=1),
    FuzzyLinear(n_c=2, random_state=1),
]


def cross_validate(model, X, y, folds, lengths=None):
    prepared = prepare(model, {"train": (X, y, lengths)})
    return prepared.cross_validated("train", folds)


class Echo(RegressorMixin, BaseEstimator):
    """A readout whose output is its first feature, so that a test can choose the errors."""

    def __init__(self, random_state=None):
        self.random_state = random_state

    def fit(self, X, y):
        self.rows_ = X
        return self

    def predict(self, X):
        return X[:, 0]


class Scripted(SequenceModel):
    def __init__(self, random_state=None):
        self.random_state = random_state

    def make_features(self):
        return TapFeatures(n_y=1, n_references=None)

    def make_readout(self):
        return Echo(self.random_state)


@pytest.mark.parametrize("model", MODELS, ids=lambda model: type(model).__name__)
def test_errors_are_those_of_readouts_trained_fold_by_fold(model):
    X, y, folds = log(), pressure(), split_rows(200, 4, "shuffled", 1)
    judged = cross_validate(model, X, y, folds)
    rows = model.make_features().fit(X).transform(X)
    for i, (train, validation) in enumerate(folds):
        readout = model.make_readout()
        if isinstance(readout, TakagiSugenoReadout):
            seed = int(np.random.SeedSequence([1, i]).generate_state(1)[0])
            readout.set_params(random_state=seed)
        readout.fit(rows[train], y[train])
        errors = (rmse(y[part], readout.predict(rows[part])) for part in (train, validation))
        assert_allclose((judged.train_rmse[i], judged.validation_rmse[i]), list(errors), rtol=1e-6)


@pytest.mark.parametrize("model", MODELS, ids=lambda model: type(model).__name__)
def test_features_of_several_recordings_restart_at_each(model):
    X, y, lengths = log(), pressure(), [120, 80]
    folds = split_blocks(lengths, 2, 1, 0)
    judged = cross_validate(model, X, y, folds, lengths=lengths)
    rows = np.vstack([model.make_features().fit(X).transform(x) for x in (X[:120], X[120:])])
    prepared = prepare(model, {"log": (X, y, lengths)})
    assert np.array_equal(prepared.rows["log"], rows)
    assert len(judged.validation_rmse) == 2
    alone = np.concatenate([judged.model.predict(x) for x in (X[:120], X[120:])])
    found = [
        evaluate(model, folds, (X, y, lengths), (X, y, several))["test_rmse_kpa"]
        for several in (lengths, None)
    ]
    assert found[0] == pytest.approx(rmse(y, alone), abs=1e-9)
    assert abs(found[0] - found[1]) > 1e-6


@pytest.mark.parametrize("model", MODELS, ids=lambda model: type(model).__name__)
def test_model_is_that_of_the_best_fold(model):
    X, y, folds = log(), pressure(), split_rows(200, 4, "blocked", 1)
    judged = cross_validate(model, X, y, folds)
    train, validation = folds[judged.best]
    predicted = judged.model.predict(X)
    assert_allclose(judged.fit, predicted, rtol=1e-12)
    assert type(judged.model) is type(model)
    assert judged.train_rmse[judged.best] == pytest.approx(rmse(y[train], predicted[train]))
    expected = rmse(y[validation], predicted[validation])
    assert judged.validation_rmse[judged.best] == pytest.approx(expected)


def test_best_fold_has_the_least_root_of_the_sum_of_squares():
    # least training error and least sum: first; least hypotenuse: second; least validation: third
    X = np.array([0.1, 5.0, 3.4, 3.4, 9.0, 1.0])[:, None]
    folds = [(np.array([2 * i]), np.array([2 * i + 1])) for i in range(3)]
    judged = cross_validate(Scripted(), X, np.zeros(6), folds)
    assert judged.train_rmse == (0.1, 3.4, 9.0)
    assert judged.validation_rmse == (5.0, 3.4, 1.0)
    assert judged.best == 1
    assert judged.model.readout_.rows_.tolist() == [[3.4]]


@pytest.mark.parametrize("wrap", [lambda readout: readout, make_pipeline], ids=["bare", "inside"])
def test_random_readout_starts_differently_in_every_fold(wrap):
    seeds = []

    class Seeded(Echo):
        def fit(self, X, y):
            seeds.append(self.random_state)
            self.fitted_ = True  # what a pipeline asks for
            return self

    class Model(Scripted):
        def make_readout(self):
            return wrap(Seeded(self.random_state))

    cross_validate(Model(random_state=40), log(), pressure(), split_rows(200, 3, "blocked", 1))
    assert len(set(seeds)) == 3
    first = seeds.copy()
    cross_validate(Model(random_state=41), log(), pressure(), split_rows(200, 3, "blocked", 1))
    assert len({*first, *seeds[3:]}) == 6


@pytest.mark.parametrize(
    "model",
    [FPRC(n_c=2, n_y=201), FuzzyLinear(n_c=151), ESN(r=5, n_y=201)],
    ids=["taps", "rules", "network taps"],
)
def test_log_that_does_not_suit_the_model_is_refused_with_its_name(model):
    with pytest.raises(EvaluationError, match=type(model).__name__):
        cross_validate(model, log(), pressure(), split_rows(200, 4, "shuffled", 1))


def test_rmse_is_the_root_of_the_mean_square():
    assert rmse(np.array([0.0, 0.0, 0.0, 0.0]), np.array([1.0, -1.0, 5.0, -3.0])) == 3.0


@pytest.mark.parametrize("output", [[0, np.nan, 0], [0, -np.inf, 0], [0, 0], [[0], [0], [0]]])
def test_output_that_is_not_finite_or_of_another_shape_is_refused(output):
    with pytest.raises(EvaluationError):
        rmse(np.zeros(3), np.array(output, dtype=float))


def log():
    time = np.arange(200) / 10.0
    return np.column_stack([20.0 + 15.0 * np.sin(time), 100.0 + 5.0 * np.sin(time - 0.5)])


def pressure():
    time = np.arange(200) / 10.0
    return 175.0 + 120.0 * np.sin(time + 0.2) + 20.0 * np.sin(time) ** 2


def test_ridge_that_learns_in_blocks_finds_the_same_errors_and_outputs():
    samples = 11_000  # more than a block of states
    time = np.arange(samples) / 200.0
    X = 30.0 + 20.0 * np.sin(time)[:, None]
    y = 175.0 + 100.0 * np.sin(time - 0.3) + np.cos(9 * time)
    model, lengths = ESN(r=8, random_state=0), [10_500, 500]
    folds = split_rows(samples, 4, "shuffled", seed=1)
    kept = crossval.prepare(model, {"train": (X, y, lengths)}).cross_validated("train", folds)
    streamed = crossval.learn(model, (X, y, lengths), folds)
    assert streamed.best == kept.best
    assert_allclose(streamed.train_rmse, kept.train_rmse, rtol=1e-7)
    assert_allclose(streamed.validation_rmse, kept.validation_rmse, rtol=1e-7)
    assert_allclose(streamed.fit, kept.fit, rtol=1e-6)
