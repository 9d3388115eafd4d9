import ast
import inspect
import re

import numpy as np
import pytest
from numpy.testing import assert_allclose
from sklearn.base import BaseEstimator, clone
from sklearn.exceptions import NotFittedError

import fprc.models
from fprc.models import (
    ESN,
    FPRC,
    NVAR,
    EchoStates,
    FeatureModel,
    FuzzyLinear,
    LowpassBank,
    PlayOperators,
    RidgeReadout,
    SideBySide,
    TakagiSugenoReadout,
    TapFeatures,
)

MAPS = [
    (TapFeatures(n_references=None), [0]),
    (PlayOperators(n_plays=3), [0]),
    (LowpassBank((1.0, 0.3)), [0]),
    (NVAR(n_taps=2, spacing=3), [0]),
]

# a washout that leaves nothing of the first state, so that "held for ever" is exact
MODELS = {
    "esn": ESN(r=20, washout=400, random_state=1),
    "fprc": FPRC(n_c=3, random_state=1),
    "fuzzy_linear": FuzzyLinear(n_c=3, random_state=1),
    "feature_model": FeatureModel(SideBySide(MAPS), RidgeReadout(alpha=1.0)),
}

COLUMNS = {"esn": 1, "fprc": 2, "fuzzy_linear": 1, "feature_model": 1}

ESTIMATORS = [
    public
    for public in vars(fprc.models).values()
    if inspect.isclass(public)
    and issubclass(public, BaseEstimator)
    and not inspect.isabstract(public)
]


@pytest.fixture(params=MODELS)
def fitted(request):
    X, y = inputs(COLUMNS[request.param], 300), pressure(300)
    return clone(MODELS[request.param]).fit(X, y)


def test_steps_after_a_reset_to_x0_continue_a_log_that_held_x0(fitted):
    X = other_inputs(fitted)
    x0 = X[0] + 4.0
    fitted.reset(x0)
    held = np.vstack([np.tile(x0, (50, 1)), X])
    assert_allclose(steps(fitted, X), fitted.predict(held)[50:], rtol=0, atol=1e-9)


@pytest.mark.parametrize("unfitted", [*MODELS.values(), *(part for part, _ in MAPS)], ids=str)
def test_stream_of_an_unfitted_estimator_is_refused(unfitted):
    for call in (clone(unfitted).step, clone(unfitted).reset):
        with pytest.raises(NotFittedError):
            call([30.0])


@pytest.mark.parametrize("cls", [ESN, FPRC, FuzzyLinear])
def test_every_parameter_reaches_the_features_or_the_readout(cls):
    own = {name: f"its {name}" for name in cls().get_params()}
    model = cls(**own)
    features, readout = model.make_features().get_params(), model.make_readout().get_params()
    assert own.items() <= (readout | features).items()


@pytest.mark.parametrize("name", MODELS)
def test_taps_longer_than_the_log_are_refused(name):
    too_many = {"features": SideBySide([(TapFeatures(41, None), [0])])}
    model = clone(MODELS[name]).set_params(**too_many if name == "feature_model" else {"n_y": 41})
    with pytest.raises(ValueError, match="n_samples = 40.*41.*longer log"):
        model.fit(inputs(COLUMNS[name], 40), pressure(40))


@pytest.mark.parametrize("bad", [1.01e9, -1e300])
def test_sample_that_is_a_fault_is_refused_by_column_and_number(bad, fitted):
    X = other_inputs(fitted)
    X[7, -1] = bad
    for call in (fitted.predict, lambda X: clone(fitted).fit(X, pressure(len(X)))):
        with pytest.raises(ValueError, match=f"column {X.shape[1] - 1}, sample 7 is "):
            call(X)


@pytest.mark.parametrize("kind", ["U9", "S9", object])
def test_numbers_as_text_train_as_numbers(kind, fitted):
    X, y = other_inputs(fitted), np.round(pressure(len(other_inputs(fitted))), 3)
    expected = clone(fitted).fit(X, y).predict(X)
    assert_allclose(clone(fitted).fit(X, y.astype(kind)).predict(X), expected, rtol=1e-12)


@pytest.mark.parametrize("kind", ["m8[ms]", "M8[D]", "word", object])
@pytest.mark.parametrize("part", [FPRC(n_c=2), RidgeReadout(), TakagiSugenoReadout(n_c=2)])
def test_targets_that_are_no_numbers_are_refused_by_name(kind, part):
    X = inputs(2, 40)
    y = np.full(40, "high") if kind == "word" else np.arange(40).astype("m8[s]").astype(kind)
    with pytest.raises(ValueError, match=r"^y: .*must be numbers"):
        clone(part).fit(X, y)


@pytest.mark.parametrize(
    "spoiled",
    [
        *(lambda x, bad=bad: [*x[:-1], bad] for bad in (np.nan, -np.inf, 1.01e9)),
        lambda x: x[:-1],
        lambda x: [*x, 31.0],
        lambda x: x[0],
    ],
    ids=["NaN", "infinite", "too large", "short", "long", "scalar"],
)
def test_step_ignores_a_sample_that_is_a_fault_or_of_another_size(spoiled, fitted):
    X = other_inputs(fitted)
    got = []
    for k, x in enumerate(X):
        if k in (0, 30):
            with pytest.raises(ValueError, match=r"must be . numbers within .*is ignored"):
                fitted.step(spoiled(x))
        got.append(fitted.step(x))
    assert_allclose(got, fitted.predict(X), rtol=0, atol=1e-9)


@pytest.mark.parametrize("spike", [1e9, -1e9])
def test_stream_recovers_from_the_largest_sample(spike, fitted):
    """Within 4,000 samples: FPRC's low-pass has to forget 1e7 kPa."""
    X = np.tile(other_inputs(fitted), (50, 1))
    spiked = X.copy()
    spiked[5] = spike
    expected = steps(fitted, X)
    fitted.reset()
    got = steps(fitted, spiked)
    assert np.all(np.isfinite(got))
    assert abs(got[5] - expected[5]) > 1e3
    assert_allclose(got[-80:], expected[-80:], rtol=0, atol=1e-6)


@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_documented_defaults_are_the_actual_ones(estimator):
    lines = inspect.cleandoc(estimator.__doc__)
    documented = dict(re.findall(r"^(\w+) : .*, default=(.+)$", lines, re.MULTILINE))
    signature = inspect.signature(estimator).parameters
    optional = {
        name: given for name, given in signature.items() if given.default is not given.empty
    }
    actual = {name: parameter.default for name, parameter in optional.items()}
    assert {name: ast.literal_eval(text) for name, text in documented.items()} == actual


def test_defaults_are_those_of_the_paper():
    shared = {"n_y": 5, "alpha": 0.001, "random_state": None}
    esn = {"r": 800, "f_input": 0.02, "gamma": 0.8, "rho": 0.4, "washout": 100}
    fuzzy = shared | {"n_c": 8, "sigma": 2.0, "restarts": 1}
    assert ESN().get_params() == shared | esn
    assert FPRC().get_params() == fuzzy | {"epsilon": 0.01, "n_u": 3}
    assert FuzzyLinear().get_params() == fuzzy


@pytest.mark.parametrize(
    ("estimator", "parameter"),
    [
        (TapFeatures(epsilon=1.5), "epsilon"),
        (type("Mine", (TapFeatures,), {})(n_y=True), "n_y"),  # from outside, on a map of ours
        (TapFeatures(n_references=2), "n_references"),
        (PlayOperators(n_plays=0), "n_plays"),
        *((LowpassBank(x), "epsilons") for x in (np.full(1001, 0.1), [], [0.1, 0.0], [np.nan])),
        (NVAR(n_taps=100, degree=3), "n_taps"),
        (EchoStates(r=5, washout=-1), "washout"),
        (EchoStates(r=5, random_state="1"), "random_state"),
        (TakagiSugenoReadout(n_c=2, restarts=2.5), "restarts"),
        (NVAR(degree=1), "degree"),
        (EchoStates(r=5, gamma=1.0), "gamma"),
        (RidgeReadout(alpha=-1e-9), "alpha"),
        (TakagiSugenoReadout(n_c=0), "n_c"),
        (TakagiSugenoReadout(n_c=2, sigma=0.0), "sigma"),
    ],
    ids=str,
)
def test_parameter_outside_its_documented_limits_is_refused_by_name(estimator, parameter):
    with pytest.raises(ValueError, match=rf"\b{parameter}\b"):
        estimator.fit(inputs(2, 40), pressure(40))


def steps(model, X):
    return np.array([model.step(x) for x in X])


def inputs(columns, size, rate=1.0):
    """Return a bending angle, and if asked for a reservoir's pressure that lags behind it."""
    time = rate * np.arange(size) / 10.0
    theta = 20.0 + 15.0 * np.sin(time)
    pressure = 100.0 + 0.3 * theta + 2.0 * np.sin(time - 0.5)
    return np.column_stack([theta, pressure])[:, :columns]


def other_inputs(model):
    return inputs(model.n_features_in_, 80, rate=1.7)


def pressure(size):
    time = np.arange(size) / 10.0
    return 175.0 + 120.0 * np.sin(time + 0.2) + 20.0 * np.sin(time) ** 2
