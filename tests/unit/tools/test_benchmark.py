"""The comparisons of `tools/benchmark.sh`."""

import numpy as np
import pytest

from fprc.models import EchoStates
from tools import benchmark


@pytest.mark.parametrize("make", benchmark.NETWORKS[1:])
def test_states_of_other_libraries_are_ours(make):
    X = np.sin(0.02 * np.arange(1.0, 301.0))[:, None]
    ours = EchoStates(r=20, washout=0, random_state=0).fit(X)
    _, expected, _ = benchmark.NETWORKS[0](ours)
    try:
        (_, log, _), (_, _, step) = make(ours), make(ours)
    except ModuleNotFoundError as error:
        pytest.skip(f"{error}")
    assert log(X) == pytest.approx(expected(X), abs=1e-12)
    if step:
        assert np.ravel(step(X[0])) == pytest.approx(expected(X)[0], abs=1e-12)


def test_scikit_fuzzy_and_ours_end_at_the_same_objective():
    noise = np.random.default_rng(1).normal(size=(400, 3))
    rows = noise + 9.0 * np.repeat(np.eye(4, 3), 100, axis=0)
    table = benchmark.clusterings(rows, 4)
    ours, theirs = (table[f"{name}: objective"].astype(float) for name in ("fprc", "scikit-fuzzy"))
    assert theirs.to_numpy() == pytest.approx(ours.to_numpy(), rel=1e-4)
