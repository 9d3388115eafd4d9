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
    old = pd.DataFrame({benchmark.PROCESSOR: ["EPYC, Zen, 2026-01-01", "Xeon, Zen, load 2"],
                        "s [1]": ["1", "2 (1 to 3)"], "empty": ["", ""]})  # fmt: skip
    block = old.to_markdown(index=False, disable_numparse=True)
    page = f"so\n<!-- a: generated -->\n{block}\n<!-- a: end -->\nit is"
    new = pd.DataFrame({"s [1]": ["5"], "empty": [""]})
    found = benchmark.with_rows(page, "a", new, "EPYC, Zen")
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in found.splitlines()[4:-2]]
    assert [row[1:] for row in rows] == [["5", ""], ["2 (1 to 3)", ""]]
    assert [row[0][:4] for row in rows] == ["EPYC", "Xeon"]
