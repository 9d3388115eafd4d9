import copy

import numpy as np
import pytest

from fprc.calibration import surrogate_errors
from fprc.config import Settings
from fprc.models import ESN, FPRC, FuzzyLinear

STRIDE, NODES, SEED = 4, 15, 5
N_Y, ALPHA, N_C, N_U = 2, 0.01, 3, 2
OTHER = {"sweep": "complex", "complex": "sweep"}
INPUTS = {"esn": ["theta_deg"], "fprc": ["theta_deg", "p_o_kpa"], "fuzzy_linear": ["theta_deg"]}
CASES = [
    (trained_on, model, phase)
    for trained_on in OTHER
    for model in INPUTS
    for phase in ("train", "test")
]


@pytest.fixture(scope="module")
def logs(seen):
    """The first 8 s of both experiments; of different lengths, since the paper's are."""
    lengths = {"sweep": 1600, "complex": 1403}
    return {
        name: {channel: values[: lengths[name]] for channel, values in log.items()}
        for name, log in seen.items()
    }


@pytest.fixture(scope="module")
def models():
    found = Settings().models.model_dump() | {"n_y": N_Y, "alpha": ALPHA}
    found["esn"] |= {"r": 9999, "washout": 10}
    found["fprc"] |= {"n_c": N_C, "n_u": N_U}
    return found


@pytest.fixture(scope="module")
def judge(logs, models):
    def call(**changes):
        settings = {"stride": STRIDE, "esn_nodes": NODES, "seed": SEED}
        return surrogate_errors(logs, models, **settings | changes)

    return call


@pytest.fixture(scope="module")
def errors(judge):
    return judge()


def build(name):
    shared = {"n_y": N_Y, "alpha": ALPHA, "random_state": SEED}
    if name == "esn":
        return ESN(r=NODES, f_input=0.02, gamma=0.8, rho=0.4, washout=10, **shared)
    if name == "fprc":
        return FPRC(epsilon=0.01, n_c=N_C, n_u=N_U, sigma=2.0, **shared)
    return FuzzyLinear(n_c=N_C, sigma=2.0, **shared)


def pair(logs, log, name):
    return np.column_stack([logs[log][key] for key in INPUTS[name]]), logs[log]["p_target_kpa"]


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def test_errors_are_those_of_each_model_in_both_directions(errors):
    assert sorted(errors) == sorted("/".join(case) for case in CASES)
    assert all(type(value) is float and value > 0.0 for value in errors.values())


@pytest.mark.parametrize(("trained_on", "model", "phase"), CASES)
def test_errors_are_those_of_a_readout_of_every_strided_row(errors, logs, trained_on, model, phase):
    X, y = pair(logs, trained_on, model)
    # the features are those of the whole log: they are in the fitted model
    features = build(model).fit(X, y).features_
    readout = build(model).make_readout().fit(features.transform(X)[::STRIDE], y[::STRIDE])
    X, y = pair(logs, trained_on if phase == "train" else OTHER[trained_on], model)
    rest = readout.predict(features.transform(X))[::STRIDE] - y[::STRIDE]
    assert errors[f"{trained_on}/{model}/{phase}"] == pytest.approx(rms(rest), rel=1e-9)


@pytest.mark.parametrize("model", INPUTS)
def test_without_a_stride_the_errors_are_those_of_the_model_itself(judge, logs, model):
    errors = judge(stride=1)
    for trained_on in OTHER:
        fitted = build(model).fit(*pair(logs, trained_on, model))
        for phase, log in (("train", trained_on), ("test", OTHER[trained_on])):
            X, y = pair(logs, log, model)
            expected = rms(fitted.predict(X) - y)
            assert errors[f"{trained_on}/{model}/{phase}"] == pytest.approx(expected, rel=1e-9)


def test_same_seed_gives_the_same_errors_and_another_seed_another_network(judge, errors):
    assert judge() == errors
    other = judge(seed=SEED + 1)
    assert all(other[f"{log}/esn/{phase}"] != errors[f"{log}/esn/{phase}"]
               for log in OTHER for phase in ("train", "test"))  # fmt: skip


def test_size_of_the_network_is_that_of_the_stand_in(judge, errors):
    other = judge(esn_nodes=NODES + 5)
    for key, value in errors.items():
        assert (other[key] == value) is ("/esn/" not in key)


def test_stand_in_leaves_settings_and_logs_alone(logs, models):
    before = copy.deepcopy(models)
    surrogate_errors(logs, models, stride=50, esn_nodes=5, seed=1)
    assert models == before
    assert "p_target_kpa" in logs["sweep"]
