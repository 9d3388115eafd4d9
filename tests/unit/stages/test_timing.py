import numpy as np
import pytest

from fprc.config import Settings
from fprc.control import PressurePI
from fprc.experiments import step_cost as cost
from fprc.experiments.data import read_data
from fprc.models import ESN, FPRC, FuzzyLinear
from fprc.registry import build

SAMPLES, WARM_UP = 300, 100


@pytest.fixture(scope="module")
def settings():
    found = Settings().model_dump()
    found["models"]["esn"] |= {"r": 10, "washout": 5}
    found["models"]["fprc"] |= {"n_c": 2}
    limit_kpa = found["tracking"]["pressure_limit_kpa"]
    return {"models": found["models"], "control": found["control"], "pressure_limit_kpa": limit_kpa}


@pytest.fixture(scope="module")
def logs(write_data):
    """A training log, and the test log whose readings are replayed."""
    return write_data(sweep=2000, complex=SAMPLES)


def measure(logs, settings):
    """Cost of a step of each model's controller."""
    train, test = map(read_data, logs)
    control, limit_kpa = settings["control"], settings["pressure_limit_kpa"]
    models = [
        build(name, settings["models"], seed=1).fit(*train.pair(name))
        for name in ("esn", "fprc", "fuzzy_linear")
    ]
    return [cost.step_cost(model, test, control, limit_kpa) for model in models]


@pytest.fixture
def clock(monkeypatch):
    """Seconds of a round of steps: the first is a warm-up, whose times are wild."""
    monkeypatch.setattr(cost, "WARM_UP", WARM_UP)
    rounds = []

    def time_steps(step, samples):
        for k in range(samples):
            step(k)
        rounds.append(samples)
        if len(rounds) % 2:
            return np.full(samples, 1e3)
        seconds = np.full(samples, 2e-5)
        seconds[-1] = 4e-3
        return seconds

    monkeypatch.setattr(cost, "time_steps", time_steps)
    return rounds


def test_cost_of_a_step_is_that_of_a_second_round(logs, settings, clock):
    costs = measure(logs, settings)
    assert clock == [WARM_UP, SAMPLES] * 3
    for entry in costs:
        assert entry["samples"] == SAMPLES
        assert entry["median_us"] == pytest.approx(20.0)
        assert entry["max_us"] == pytest.approx(4000.0)
        assert entry["budget_us"] == pytest.approx(5000.0)
        # linear interpolation between the two largest of 300: at 0.999 * 299 = 298.701
        assert entry["p99_9_us"] == pytest.approx(20.0 + 0.701 * 3980.0)


def spy(monkeypatch, kind):
    """Return a list, to which each step of an object of this class adds what it is given."""
    seen, step = [], kind.step

    def noting(self, *given):
        seen.append(given)
        return step(self, *given)

    monkeypatch.setattr(kind, "step", noting)
    return seen


def test_each_step_of_a_controller_is_fed_the_log_and_runs_both_pressure_loops(
    logs, settings, clock, monkeypatch
):
    models = {model: spy(monkeypatch, model) for model in (ESN, FPRC, FuzzyLinear)}
    loops = spy(monkeypatch, PressurePI)
    measure(logs, settings)
    data = read_data(logs[1]).channels
    for model, seen in models.items():
        inputs = ["theta_deg", "p_o_kpa"][: 1 + (model is FPRC)]
        expected = np.column_stack([data[name] for name in inputs])
        fed = [x for (x,) in seen]
        np.testing.assert_array_equal(fed, np.concatenate([expected[:WARM_UP], expected]))
    assert len(loops) == 2 * 3 * (WARM_UP + SAMPLES)
    begin, end = 2 * WARM_UP, 2 * (WARM_UP + SAMPLES)
    main, reservoir = loops[begin:end:2], loops[begin + 1 : end : 2]
    np.testing.assert_array_equal([reading for _, reading in main], data["p_target_kpa"])
    assert all(0.0 <= setpoint <= 450.0 for setpoint, _ in main)
    np.testing.assert_allclose([setpoint for setpoint, _ in reservoir], 7.0 * data["theta_deg"])
