"""The comparisons of `make benchmark`."""

import numpy as np
import pytest

from fprc.models import EchoStates
from tools.benchmark import speed
from tools.benchmark.peers import PEERS


@pytest.fixture
def network():
    """Return the features of a small ESN, and a log."""
    X = np.sin(0.02 * np.arange(300.0))[:, None]
    return EchoStates(r=20, washout=0, random_state=0).fit(X), X


@pytest.mark.parametrize(("package", "make"), PEERS.values(), ids=list(PEERS))
def test_states_and_steps_of_other_libraries_are_ours(network, package, make):
    features, X = network
    expected = speed.ours(features).states(X)
    assert expected == pytest.approx(features.transform(np.vstack([X, X[:1]]))[1:, 5:], abs=1e-14)
    pytest.importorskip(package)
    assert make(features).states(X) == pytest.approx(expected, abs=1e-12)
    if step := make(features).step:
        assert np.array([np.ravel(step(x)) for x in X]) == pytest.approx(expected, abs=1e-12)
