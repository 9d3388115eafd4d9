import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.model_selection import KFold, TimeSeriesSplit, cross_val_score

from fprc.errors import EvaluationError
from fprc.evaluation import settled_rmse, split_rows
from fprc.evaluation.folds import split_blocks
from fprc.models import FeatureModel, RidgeReadout, TapFeatures

sizes = st.tuples(st.integers(2, 8), st.integers(8, 60))
splits = st.sampled_from(["shuffled", "blocked"])


@given(sizes, splits, st.integers(0, 2**32 - 1))
def test_every_row_validates_once_and_trains_in_all_other_folds(size, split, seed):
    folds, samples = size
    pairs = split_rows(samples, folds, split, seed)
    assert len(pairs) == folds
    validated = np.concatenate([validation for _, validation in pairs])
    assert sorted(validated) == list(range(samples))
    counts = {len(validation) for _, validation in pairs}
    assert counts <= {samples // folds, -(-samples // folds)}
    for train, validation in pairs:
        assert sorted([*train, *validation]) == list(range(samples))


def test_shuffled_folds_repeat_with_their_seed_only():
    first, again, other = (split_rows(100, 5, "shuffled", seed) for seed in (3, 3, 4))
    assert all(np.array_equal(a[1], b[1]) for a, b in zip(first, again, strict=True))
    assert not any(np.array_equal(a[1], b[1]) for a, b in zip(first, other, strict=True))


@given(st.integers(2, 6), st.integers(40, 200), st.integers(1, 4), splits)
def test_purged_rows_neither_train_nor_neighbour_the_block(folds, samples, purge, split):
    whole = split_rows(samples, folds, split, 1)
    for (train, block), (before, same) in zip(
        split_rows(samples, folds, split, 1, purge), whole, strict=True
    ):
        np.testing.assert_array_equal(block, same)
        near = {row + shift for row in block for shift in range(-purge, purge + 1)}
        assert set(train) == set(before) - (near if split == "blocked" else set())


@pytest.mark.parametrize(
    ("samples", "folds", "split", "more"),
    [(4, 5, "blocked", {}), (4, 1, "blocked", {}), (4, 0, "blocked", {}), (0, 2, "blocked", {}),
     (10, 2, "random", {}), (40, 2, "blocked", {"purge": 30})],
)  # fmt: skip
def test_split_that_gives_no_folds_is_refused(samples, folds, split, more):
    with pytest.raises(EvaluationError):
        split_rows(samples, folds, split, 1, **more)


@given(
    st.lists(st.integers(20, 60), min_size=1, max_size=12),
    st.integers(2, 10),
    st.integers(1, 30),
    st.integers(0, 4),
)
def test_blocks_lie_in_one_recording_and_leave_only_their_neighbours_out(
    lengths, blocks, shortest, purge
):
    recording = np.repeat(np.arange(len(lengths)), lengths)
    folds = split_blocks(lengths, blocks, shortest, purge)
    assert np.array_equal(np.concatenate([block for _, block in folds]), np.arange(sum(lengths)))
    for train, block in folds:
        own = recording[block[0]]
        assert set(recording[block]) == {own}
        assert len(block) >= min(shortest, lengths[own] // 2)
        distance = np.abs(np.arange(sum(lengths))[:, None] - block).min(axis=1)
        assert np.array_equal(train, np.flatnonzero((recording != own) | (distance > purge)))
    if shortest == 1:
        assert len(folds) >= min(blocks, sum(lengths))
    if len(lengths) >= blocks:
        assert len(folds) == max(len(lengths), 2)


@pytest.mark.parametrize(("shortest", "blocks"), [(100, 10), (101, 9), (400, 2), (2000, 2)])
def test_short_recording_has_fewer_blocks(shortest, blocks):
    assert len(split_blocks([1000], 10, shortest, 10)) == blocks


def test_right_folds_find_a_model_of_memory_that_shuffled_rows_spoil():
    """y is theta one sample ago: two taps give it exactly, on rows that are one sample apart."""
    theta = 30.0 + 20.0 * np.cumsum(np.random.default_rng(1).standard_normal(900)) / 30.0
    X, y = theta[:, None], np.concatenate([theta[:1], theta[:-1]])
    model = FeatureModel(TapFeatures(n_y=2, n_references=None), RidgeReadout(1e-9))

    def error(cv):
        return -cross_val_score(model, X, y, cv=cv, scoring=settled_rmse(1)).mean()

    assert error(TimeSeriesSplit(5)) < 1e-3
    assert error(KFold(5, shuffle=True, random_state=1)) > 0.1


def test_settling_samples_do_not_count():
    model = FeatureModel(TapFeatures(n_y=2, n_references=None), RidgeReadout())
    X = np.arange(50.0)[:, None]
    model.fit(X, X[:, 0])
    y = X[:, 0].copy()
    y[:5] += 100.0
    assert settled_rmse(5)(model, X, y) > -0.1
    assert settled_rmse(4)(model, X, y) < -1.0
    column = pd.DataFrame({"p_exp": y})  # not a difference of every row with every other
    assert settled_rmse(4)(model, X, column) == settled_rmse(4)(model, X, y)
