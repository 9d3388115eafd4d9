import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.errors import EvaluationError
from fprc.evaluation import split_rows
from fprc.evaluation.blocks import split_blocks


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


def test_blocks_of_one_recording_are_the_blocked_folds():
    ours, theirs = split_blocks([1000], 10, 50, 20), split_rows(1000, 10, "blocked", 1, 20)
    for pair in zip(ours, theirs, strict=True):
        assert all(map(np.array_equal, *pair))


@pytest.mark.parametrize(("shortest", "blocks"), [(100, 10), (101, 9), (400, 2), (2000, 2)])
def test_short_recording_has_fewer_blocks(shortest, blocks):
    assert len(split_blocks([1000], 10, shortest, 10)) == blocks


def test_purge_that_leaves_a_block_nothing_to_train_is_an_error():
    with pytest.raises(EvaluationError, match="leave none of 1000 to train"):
        split_blocks([1000], 10, 400, 500)
