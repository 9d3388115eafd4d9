"""The comparisons of `tools/benchmark.sh`."""

import numpy as np
import pandas as pd
import pytest

from fprc.models import EchoStates
from tools import benchmark


@pytest.fixture
def network():
    """Return the features of a small ESN, and a log."""
    X = np.sin(0.02 * np.arange(300.0))[:, None]
    return EchoStates(r=20, washout=0, random_state=0).fit(X), X


@pytest.mark.parametrize(("package", "make"), benchmark.PEERS.values(), ids=list(benchmark.PEERS))
def test_states_and_steps_of_other_libraries_are_ours(network, package, make):
    features, X = network
    states, _ = benchmark.ours(features)
    expected = states(X)
    pytest.importorskip(package)
    (states, _), (_, step) = make(features), make(features)
    assert states(X) == pytest.approx(expected, abs=1e-12)
    if step:
        assert np.array([np.ravel(step(x)) for x in X]) == pytest.approx(expected, abs=1e-12)


def test_rows_of_other_processors_stay_and_those_of_this_one_are_replaced():
    old, other = "EPYC, Zen, 2026-01-01", "Xeon, SkylakeX, 2026-01-02"
    first = pd.DataFrame({benchmark.PROCESSOR: [old, other, other], "s": ["1", "2", ""]})
    second = pd.DataFrame({benchmark.PROCESSOR: [other], "objective": ["4"]})
    plain = {"index": False, "disable_numparse": True}
    block = f"\n{first.to_markdown(**plain)}\n\nwords\n\n{second.to_markdown(**plain)}\n"
    new = pd.DataFrame({benchmark.PROCESSOR: ["EPYC, Zen, 2026-02-02"], "s": ["5"]})
    assert benchmark.with_others(new, block.splitlines())["s"].tolist() == ["5", "2", ""]
