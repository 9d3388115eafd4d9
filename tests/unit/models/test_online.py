import numpy as np
import pytest
from sklearn.base import clone
from sklearn.exceptions import NotFittedError

from fprc.models import (
    ESN,
    FPRC,
    FeatureModel,
    FuzzyLinear,
    Learning,
    Online,
    PlayOperators,
    RidgeReadout,
    SideBySide,
    TapFeatures,
    load_model,
    save_model,
)
from fprc.models.online import prior_of

PERIOD_S = 0.005
MODELS = {
    "fprc": FPRC(n_c=3, random_state=1),
    "fuzzy_linear": FuzzyLinear(n_c=3, random_state=1),
    "plays": FeatureModel(
        SideBySide([(PlayOperators(n_plays=3), [0, 1]), (TapFeatures(), [0, 1])]), RidgeReadout()
    ),
}


def log(samples=3000, seed=0):
    rng = np.random.default_rng(seed)
    time_s = PERIOD_S * np.arange(samples)
    theta = 30.0 + 25.0 * np.sin(2.0 * np.pi * (0.3 + 0.01 * time_s) * time_s)
    p_o = 110.0 + np.cumsum(0.05 * (theta - 30.0)) * PERIOD_S + 0.1 * rng.standard_normal(samples)
    y = 5.0 * theta + 0.02 * theta**2 + 0.5 * p_o + rng.standard_normal(samples)
    return np.column_stack([theta, p_o]), y


def columns(name, X):
    return X[:, :1] if name == "fuzzy_linear" else X


@pytest.fixture(params=MODELS)
def model(request):
    X, y = log()
    X = columns(request.param, X)
    return clone(MODELS[request.param]).fit(X, y).remember(X), X


def test_model_that_remembers_nothing_or_has_too_many_weights_is_refused():
    X, y = log()
    with pytest.raises(ValueError, match="remembers no training data"):
        Online(FPRC(n_c=3, random_state=1).fit(X, y), Learning(), PERIOD_S)
    esn = ESN(r=600, washout=10, random_state=1).fit(X[:, :1], y)
    with pytest.raises(ValueError, match="at most 512 weights"):
        esn.remember(X[:, :1])


def test_model_whose_training_failed_is_not_fitted():
    X, y = log(300)
    model = FPRC(n_c=1, n_y=400)
    with pytest.raises(ValueError, match="fewer taps"):
        model.fit(X, y)
    for use in (model.predict, lambda X: model.step(X[0]), model.remember):
        with pytest.raises(NotFittedError):
            use(X)


def test_what_is_remembered_is_saved_and_loaded(model, tmp_path):
    found, _ = model
    save_model(found, tmp_path / "model.h5")
    loaded = load_model(tmp_path / "model.h5")
    np.testing.assert_array_equal(loaded.information_, found.information_)


def test_what_is_remembered_is_of_each_recording_alone():
    X = [30.0 * np.random.default_rng(n).normal(size=(n, 2)) for n in (40, 50)]
    model = clone(MODELS["fprc"]).fit(X[0], X[0][:, 0])
    alone = sum(model.remember(x).information_ for x in X)
    both = model.remember(np.concatenate(X), [40, 50]).information_
    np.testing.assert_allclose(both, alone, rtol=1e-12)


@pytest.mark.parametrize(
    "spoil",
    [np.zeros_like, np.negative, lambda info: info - 2.0 * np.diag(np.diag(info))],
    ids=["zeros", "negative", "indefinite"],
)
def test_information_that_no_training_has_is_refused_before_a_step(model, spoil):
    found, _ = model
    found.information_ = spoil(found.information_)
    with pytest.raises(ValueError, match="information_"):
        Online(found, Learning(), PERIOD_S)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 100.0, 1e3])
def test_model_of_numbers_of_any_size_can_learn(scale):
    X, y = log()
    settings = {"sigma": 2.0 * scale, "alpha": 1e-3 * scale**2}
    found = FPRC(n_c=3, random_state=1, **settings).fit(X * scale, y * scale)
    prior = Online(found.remember(X * scale), Learning(), PERIOD_S).prior
    size = np.sqrt(np.diag(prior))
    assert np.linalg.eigvalsh(prior / np.outer(size, size)).min() > -1e-6


# --- the online model -------------------------------------------------------------------------


def test_learning_is_plain_recursive_least_squares_with_a_prior(model):
    """Against the formulas of the class, with matrices written out."""
    found, X = model
    settings = Learning(prior_s=2.0, memory_s=5.0, delay_s=0.02, kpa_per_deg=3.0)
    online = Online(found, settings, PERIOD_S, 1e6)
    prior, weights = prior_of(found, 2.0, PERIOD_S), found.readout_.weights
    phi = found.readout_.regressors(found.features_.transform(X))
    cov, v, sent = prior.copy(), np.zeros(len(prior)), []
    for k, x in enumerate(X[:400]):
        error = np.sin(0.05 * k)
        online.learn(error, 30.0)
        if k >= 4:
            then = phi[k - 4]
            gain = cov @ then / (1.0 + then @ cov @ then)
            v = v + gain * (sent[k - 4] + 3.0 * error - (weights + v) @ then)
            cov = 0.999 * (cov - np.outer(gain, then @ cov)) + 0.001 * prior
        sent.append((weights + v) @ phi[k])
        assert online.step(x) == pytest.approx(sent[k], rel=1e-4)
        online.sent(0.0)
    assert np.abs(v).max() > 0.0
    np.testing.assert_allclose(online.covariance, cov, atol=1e-4 * np.abs(prior).max())


def test_covariance_never_exceeds_the_prior_however_little_moves(model):
    found, X = model
    online = Online(found, Learning(memory_s=1.0), PERIOD_S, 1e6)
    for k in range(4000):  # at rest: only one direction is excited
        online.learn(1.0 if k % 2 else -1.0, 30.0)
        online.step(X[0])
    scale = np.sqrt(np.outer(np.diag(online.prior), np.diag(online.prior)))
    excess = np.linalg.eigvalsh((online.covariance - online.prior) / scale)
    assert excess.max() < 1e-6
    assert np.linalg.eigvalsh(online.covariance / scale).min() > -1e-6


def test_constant_error_of_the_model_is_learned(model):
    """A plant that needs 20 kPa more than the model says, at 5 kPa a degree."""
    found, X = model
    online = Online(found, Learning(prior_s=0.5, kpa_per_deg=5.0), PERIOD_S, 1e6)
    needed, errors, given = found.predict(X) + 20.0, [], [0.0] * 4
    for k, x in enumerate(X):
        error = (needed[k - 4] - given[-4]) / 5.0 if k >= 4 else 0.0
        errors.append(error)
        online.learn(error, 30.0)
        given.append(online.step(x))
    assert errors[4] == pytest.approx(4.0)
    assert np.abs(errors[-200:]).max() < 0.4
    assert online.p_learned_kpa == pytest.approx(20.0, abs=2.0)
    online.reset()
    assert online.step(X[0]) == pytest.approx(found.predict(X[:10])[0])


@pytest.mark.parametrize(
    ("error", "theta", "p_fb", "limit"),
    [
        pytest.param(5.0, 0.4, 0.0, 1e6, id="at the stop"),
        pytest.param(5.0, np.nan, 0.0, 1e6, id="no angle"),
        pytest.param(-46.0, 30.0, 0.0, np.inf, id="error that is a fault"),
        pytest.param(5.0, 1e4, 0.0, np.inf, id="angle that is a fault"),
        pytest.param(5.0, 30.0, np.nan, 1e6, id="unknown feedback"),
        pytest.param(5.0, 30.0, 1e6, 1e6, id="above the limit"),
        pytest.param(-5.0, 30.0, -1e6, 1e6, id="below 0"),
        pytest.param(5.0, 30.0, 0.0, 1.0, id="P_ff above the limit"),
    ],
)
def test_nothing_is_learned_where_the_error_tells_nothing(model, error, theta, p_fb, limit):
    found, X = model
    online = Online(found, Learning(), PERIOD_S, limit)
    for x in X[:50]:
        online.learn(error, theta)
        online.step(x)
        online.sent(p_fb)
    assert not online.learned.any()


FAULTS = {
    "one sample": lambda k: 200.0 if k == 1200 else None,
    "one sample, 1e8": lambda k: 1e8 if k == 1200 else None,
    "first sample": lambda k: 1e8 if k == 0 else None,
    "1 s, in range": lambda k: 120.0 if 1200 <= k < 1400 else None,
    "1 s, out of range": lambda k: -1e5 if 1200 <= k < 1400 else None,
    "again and again": lambda k: 55.0 if k % 50 == 0 else None,
}


@pytest.mark.parametrize("fault", FAULTS.values(), ids=FAULTS)
def test_faulty_angle_costs_learning_no_more_than_none(model, fault):
    """The plant needs 20 kPa more than the model says, at 5 kPa a degree."""
    found, X = model
    learning = Learning(prior_s=0.5, kpa_per_deg=5.0)
    needed, off = found.predict(X) + 20.0, []
    for angle in (np.nan, None):  # a dropout of the sensor, then the fault
        online, given, errors = Online(found, learning, PERIOD_S, 1e6), [0.0] * 4, []
        for k, x in enumerate(X):
            error = (needed[k - 4] - given[-4]) / 5.0 if k >= 4 else 0.0
            errors.append(error)
            theta = 30.0 if fault(k) is None else (angle or fault(k))
            online.learn(error if theta == 30.0 else x[0] - theta, theta)
            given.append(online.step(x))
        off.append(np.sqrt(np.mean(np.square(errors[2400:]))))
    assert off[1] <= 1.1 * off[0] + 1e-3


@pytest.mark.parametrize(("p_fb", "error"), [(-1e6, 5.0), (1e6, -5.0)])
def test_command_at_its_limit_is_led_back_even_from_the_stop(model, p_fb, error):
    found, X = model
    online = Online(found, Learning(), PERIOD_S, 1e5)
    for x in X[:50]:
        online.learn(error, 0.0)
        online.step(x)
        online.sent(p_fb)
    assert np.sign(online.p_learned_kpa) == np.sign(error)


def test_learned_part_stays_within_its_limit(model):
    found, X = model
    online = Online(found, Learning(limit_kpa=10.0, prior_s=0.1), PERIOD_S, 1e6)
    for x in X:
        online.learn(40.0, 30.0)
        online.step(x)
        assert abs(online.p_learned_kpa) <= 10.0
    assert np.isfinite(online.learned).all()
    assert np.abs(online._phi @ online.learned).max() < 200.0
