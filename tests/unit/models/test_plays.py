import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fprc.models import PlayOperators

numbers = st.floats(-50, 50, allow_subnormal=False)
paths = st.lists(numbers, min_size=1, max_size=30)


@given(paths, paths)
def test_plays_are_those_of_a_loop_over_samples_and_columns(first, second):
    size = min(len(first), len(second))
    X = np.column_stack([first[:size], second[:size]])
    features = PlayOperators(n_plays=3).fit([[-30.0, 0.0], [30.0, 8.0]])
    expected = np.empty((size, 6))
    for i, widths in enumerate([[7.5, 15.0, 22.5], [1.0, 2.0, 3.0]]):
        for j, r in enumerate(widths):
            p = X[0, i]
            for k, x in enumerate(X[:, i]):
                p = max(x - r, min(x + r, p))
                expected[k, 3 * i + j] = p
    assert np.array_equal(features.transform(X), expected)
    assert np.array_equal([features.step(x) for x in X], expected)
