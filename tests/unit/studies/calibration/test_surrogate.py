import numpy as np
import pytest

from fprc.config import Settings
from fprc.experiments.comparison import CrossValidation, compare_models
from fprc.experiments.data import simulate
from fprc.models import ESN, FPRC, FuzzyLinear
from fprc.studies.calibration import surrogate
from fprc.studies.calibration.objective import EPSILONS
from fprc.studies.calibration.surrogate import judge_by_surrogate, judge_fully

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
def logs(on_rig):
    return {name: data.channels for name, data in simulate(on_rig, SEED).items()}


@pytest.fixture(scope="module")
def models():
    found = Settings().models.model_dump() | {"n_y": N_Y, "alpha": ALPHA}
    found["esn"] |= {"r": 9999, "washout": 10}
    found["fprc"] |= {"n_c": N_C, "n_u": N_U}
    return found


@pytest.fixture(scope="module")
def judge(on_rig, models, tracking):
    how = {"models": models, "folds": 2, "split": "shuffled"}

    def call(centers=()):
        with pytest.MonkeyPatch.context() as small:
            for name, value in (("STRIDE", STRIDE), ("ESN_NODES", NODES)):
                small.setattr(surrogate, name, value)
            return judge_by_surrogate(
                on_rig, SEED, dict(centers), validation=how, tracking=tracking
            )

    return call


@pytest.fixture(scope="module")
def judged(judge):
    return judge()


def build(name, **changed):
    """Return a model whose ridge parameter is as strong as on four fifths of all rows."""
    shared = {"n_y": N_Y, "alpha": ALPHA / (0.8 * STRIDE), "random_state": SEED}
    if name == "esn":
        return ESN(r=NODES, f_input=0.02, gamma=0.8, rho=0.4, washout=10, **shared | changed)
    fuzzy = {"n_c": N_C, "sigma": 2.0} | shared
    if name == "fprc":
        return FPRC(**{"epsilon": 0.01, "n_u": N_U} | fuzzy | changed)
    return FuzzyLinear(**fuzzy | changed)


def pair(logs, log, name):
    return np.column_stack([logs[log][key] for key in INPUTS[name]]), logs[log]["p_target_kpa"]


def fitted(logs, trained_on, name, **changed):
    """Return features of whole logs and a readout of every strided row."""
    X, y = pair(logs, trained_on, name)
    model = build(name, **changed)
    features = model.make_features().fit(X)
    return features, model.make_readout().fit(features.transform(X)[::STRIDE], y[::STRIDE])


def error_of(logs, parts, name, log):
    features, readout = parts
    X, y = pair(logs, log, name)
    return rms(readout.predict(features.transform(X))[::STRIDE] - y[::STRIDE])


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.mark.parametrize(("trained_on", "model", "phase"), CASES)
def test_errors_are_those_of_a_readout_of_every_strided_row(judged, logs, trained_on, model, phase):
    log = trained_on if phase == "train" else OTHER[trained_on]
    expected = error_of(logs, fitted(logs, trained_on, model), model, log)
    assert judged["errors"][f"{trained_on}/{model}/{phase}"] == pytest.approx(expected, rel=1e-9)


def test_cells_of_epsilon_are_those_of_models_with_it(judged, logs):
    for epsilon, found in zip(EPSILONS, judged["epsilon"], strict=True):
        expected = error_of(logs, fitted(logs, "sweep", "fprc", epsilon=epsilon), "fprc", "sweep")
        assert found == pytest.approx(expected, rel=1e-9)


def test_clusterings_begin_at_the_given_centres(judge, judged):
    """Where they end they stay, and equal centres remain one rule."""
    centers = judged["centers"]
    again = judge(centers=centers)
    assert again["errors"] == pytest.approx(judged["errors"], rel=1e-4)
    equal = {what: np.repeat(c[:1], len(c), axis=0) for what, c in centers.items()}
    key = "sweep/fprc/train"
    assert judge(centers=equal)["errors"][key] > 1.5 * judged["errors"][key]


def test_full_models_are_those_of_the_comparison(on_rig, models, tracking):
    small = {**models, "esn": {**models["esn"], "r": NODES}}
    how = {"models": small, "folds": 2, "split": "shuffled"}
    found = judge_fully(on_rig, SEED, validation=how, tracking=tracking)
    reports = compare_models(simulate(on_rig, SEED), CrossValidation(**how, seed=SEED))[0]["models"]
    for report in reports:
        key = f"{report['trained_on']}/{report['model']}/test"
        assert found["errors"][key] == pytest.approx(report["test_rmse_kpa"], rel=1e-9)
