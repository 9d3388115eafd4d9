import numpy as np
import pytest
from sklearn.model_selection import GridSearchCV, KFold, TimeSeriesSplit, cross_val_score

from fprc.evaluation import TimeBlocks, settled_rmse
from fprc.models import FPRC, FeatureModel, RidgeReadout, TapFeatures


@pytest.mark.parametrize(("samples", "folds", "gap"), [(10, 2, 0), (103, 5, 7), (24, 24, 1)])
def test_stretches_are_whole_and_apart_and_test_each_sample_once(samples, folds, gap):
    splits = list(TimeBlocks(folds, gap).split(np.zeros((samples, 1))))
    assert len(splits) == TimeBlocks(folds).get_n_splits() == folds
    for train, test in splits:
        assert (np.diff(train) == 1).all()
        assert (np.diff(test) == 1).all()
        assert min(abs(test[0] - train[-1]), abs(train[0] - test[-1])) == gap + 1
    np.testing.assert_array_equal(np.concatenate([test for _, test in splits]), np.arange(samples))


@pytest.mark.parametrize(("folds", "gap"), [(1, 0), (11, 0), (2, 5)])
def test_impossible_folds_are_refused(folds, gap):
    with pytest.raises(ValueError, match="n_splits|gap"):
        list(TimeBlocks(folds, gap).split(np.zeros((10, 1))))


def test_right_folds_find_a_model_of_memory_that_shuffled_rows_spoil():
    """y is theta one sample ago: two taps give it exactly, on rows that are one sample apart."""
    theta = 30.0 + 20.0 * np.cumsum(np.random.default_rng(1).standard_normal(900)) / 30.0
    X, y = theta[:, None], np.concatenate([theta[:1], theta[:-1]])
    model = FeatureModel(TapFeatures(n_y=2, n_references=None), RidgeReadout(1e-9))

    def error(cv):
        return -cross_val_score(model, X, y, cv=cv, scoring=settled_rmse(1)).mean()

    assert error(TimeBlocks(5)) < 1e-3
    assert error(TimeSeriesSplit(5)) < 1e-3
    assert error(KFold(5, shuffle=True, random_state=1)) > 0.1
    search = GridSearchCV(
        FPRC(n_c=2, random_state=1), {"n_y": [1, 2]}, cv=TimeBlocks(3), scoring=settled_rmse(5)
    )
    assert search.fit(np.c_[X, y], y).best_score_ < 0.0


def test_settling_samples_do_not_count():
    model = FeatureModel(TapFeatures(n_y=2, n_references=None), RidgeReadout())
    X = np.arange(50.0)[:, None]
    model.fit(X, X[:, 0])
    y = X[:, 0].copy()
    y[:5] += 100.0
    assert settled_rmse(5)(model, X, y) > -0.1
    assert settled_rmse(4)(model, X, y) < -1.0
