import re

import numpy as np
import pytest
from numpy.testing import assert_allclose
from sklearn.base import clone

from fprc.models import (
    NVAR,
    EchoStates,
    LowpassBank,
    PlayOperators,
    RidgeReadout,
    SideBySide,
    TapFeatures,
)

PARTS = [
    (TapFeatures(n_y=2, n_references=None), [0]),
    (PlayOperators(n_plays=3), [1, 0]),
    (LowpassBank((1.0, 0.2)), range(3)),
    (NVAR(n_taps=2, spacing=4), np.array([2])),
    (EchoStates(r=5, random_state=0), [2, 1]),
]


def log(size=60, seed=0):
    return np.cumsum(np.random.default_rng(seed).normal(size=(size, 3)), axis=0)


def test_features_are_those_of_each_map_side_by_side():
    X, other = log(), log(seed=1)
    expected = np.hstack(
        [
            clone(features).fit(X[:, columns]).transform(other[:, columns])
            for features, columns in PARTS
        ]
    )
    features = SideBySide(PARTS).fit(X)
    assert np.array_equal(features.transform(other), expected)
    assert_allclose([features.step(x) for x in other], expected, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize(
    ("maps", "problem"),
    [([], "maps = []"), ([(TapFeatures(), [0, 3])], "column 3"),
     ([(TapFeatures(), [-1])], "column -1"), ([(TapFeatures(), [1.0])], "column 1.0"),
     ([(TapFeatures(), [True])], "column True"),
     ([(RidgeReadout(), [0])], "RidgeReadout() in maps"),
     ([TapFeatures()], "maps = [TapFeatures()]"),
     ([(TapFeatures(), None)], "maps = [(TapFeatures(), None)]"), (3, "maps = 3")],
)  # fmt: skip
def test_maps_that_do_not_fit_are_refused(maps, problem):
    with pytest.raises(ValueError, match=re.escape(problem)):
        SideBySide(maps).fit(log())
