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
    ("taps", TapFeatures(n_y=2, n_references=None), [0]),
    ("plays", PlayOperators(n_plays=3), [1, 0]),
    ("bank", LowpassBank((1.0, 0.2)), None),
    ("nvar", NVAR(n_taps=2, spacing=4), np.array([2])),
    ("network", EchoStates(r=5, random_state=0), [2, 1]),
]


def log(size=60, seed=0):
    return np.cumsum(np.random.default_rng(seed).normal(size=(size, 3)), axis=0)


def test_features_are_those_of_each_map_side_by_side():
    X, other = log(), log(seed=1)
    expected = np.hstack(
        [
            clone(features)
            .fit(X if columns is None else X[:, columns])
            .transform(other if columns is None else other[:, columns])
            for _, features, columns in PARTS
        ]
    )
    features = SideBySide(PARTS).fit(X)
    assert np.array_equal(features.transform(other), expected)
    assert_allclose([features.step(x) for x in other], expected, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize(
    ("maps", "problem"),
    [
        ([], "maps = []"),
        ([PARTS[0], PARTS[0]], "'taps'"),
        ([("a__b", TapFeatures(), None)], "'a__b'"),
        ([("maps", TapFeatures(), None)], "'maps'"),
        ([("taps", TapFeatures(), [0, 3])], "'taps' needs column 3"),
        ([("taps", TapFeatures(), [-1])], "'taps' needs column -1"),
        ([("taps", TapFeatures(), [1.0])], "'taps' needs column 1.0"),
        ([("taps", TapFeatures(), [True])], "'taps' needs column True"),
        ([("ridge", RidgeReadout(), None)], "'ridge' is RidgeReadout; must be a FeatureMap"),
        ([("taps", TapFeatures())], "must be a list of (name, map, columns)"),
        (3, "must be a list of (name, map, columns)"),
    ],
)
def test_maps_that_do_not_fit_are_refused(maps, problem):
    with pytest.raises(ValueError, match=re.escape(problem)):
        SideBySide(maps).fit(log())
