import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from sklearn.base import clone

from fprc.errors import EvaluationError
from fprc.evaluation import prepare
from fprc.models import ESN, FPRC, FuzzyLinear

MODELS = {
    "esn": ESN(r=12, washout=30, random_state=1),
    "fprc": FPRC(n_c=3, random_state=1),
    "fuzzy_linear": FuzzyLinear(n_c=3, random_state=1),
}
LENGTHS = [60, 7, 90]


@pytest.fixture(params=MODELS)
def model(request):
    return clone(MODELS[request.param])


@pytest.fixture
def recordings(model):
    """Inputs and outputs of three recordings that begin far apart."""
    rng = np.random.default_rng(3)
    columns = 2 if isinstance(model, FPRC) else 1
    X = [
        start + np.cumsum(rng.normal(size=(length, columns)), axis=0)
        for start, length in zip((0.0, 40.0, -30.0), LENGTHS, strict=True)
    ]
    return X, [2.0 * x[:, 0] + np.roll(x[:, -1], 1) for x in X]


@settings(max_examples=20, deadline=None)
@given(st.lists(st.integers(5, 20), min_size=1, max_size=5), st.sampled_from(sorted(MODELS)))
def test_features_equal_a_stream_that_is_reset_at_each_recording(lengths, name):
    X = 30.0 * np.random.default_rng(sum(lengths)).normal(size=(sum(lengths), 2))
    features = clone(MODELS[name]).make_features().fit(X)
    starts = np.cumsum([0, *lengths])
    stepped = []
    for k, x in enumerate(X):
        if k in starts:
            features.reset()
        stepped.append(features.step(x))
    assert_allclose(features.transform(X, lengths), stepped, rtol=0, atol=1e-9)


def test_recording_that_is_shorter_than_the_taps_is_named(model, recordings):
    X, y = map(np.concatenate, recordings)
    with pytest.raises(EvaluationError, match="2 of 3: n_samples = 3 is"):
        prepare(model, {"all": (X, y, [60, 3, 94])})


@pytest.mark.parametrize("lengths", [[60], [60, 90], [60, 90, 100], [60, 97, 0], [160, -3], []])
def test_lengths_that_do_not_make_up_the_log_are_refused(lengths, model, recordings):
    X, y = map(np.concatenate, recordings)
    with pytest.raises(EvaluationError, match=f"{len(X)} samples"):
        prepare(model, {"all": (X, y, lengths)})


def test_what_is_remembered_is_of_each_recording_alone():
    X = [30.0 * np.random.default_rng(n).normal(size=(n, 2)) for n in (40, 50)]
    model = clone(MODELS["fprc"]).fit(X[0], X[0][:, 0])
    alone = sum(model.remember(x).information_ for x in X)
    both = model.remember(np.concatenate(X), [40, 50]).information_
    assert_allclose(both, alone, rtol=1e-12)
