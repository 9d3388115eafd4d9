import numpy as np
import pytest
from numpy.testing import assert_allclose
from threadpoolctl import threadpool_limits

from fprc.config import check
from fprc.errors import ConfigError
from fprc.registry import COMPETITORS, build


@pytest.fixture(scope="module")
def models():
    return check({}).model_dump(mode="json")["models"]


@pytest.mark.parametrize("name", COMPETITORS)
def test_competitor_learns_a_loop_and_steps_as_it_predicts(name, models):
    X, y = log(COMPETITORS[name].inputs)
    small = {"esn": {"r": 20}, "trees": {"max_iter": 20}}.get(name, {})
    model = build(name, models, 1, **small)
    with threadpool_limits(1):  # threads of the trees wait for each other on a busy machine
        model.fit(X, y)
        predicted = model.predict(X)
        stepped = [model.step(x) for x in X[:130]]
    assert np.sqrt(np.mean((predicted - y) ** 2)) < 0.4 * y.std()
    assert_allclose(stepped, predicted[:130], rtol=0, atol=1e-6)


@pytest.mark.parametrize("name", ["mlp", "trees", "plays_fuzzy", "fprc_lowpass"])
def test_seed_decides_what_is_random(name, models):
    found = build(name, models, 8).make_readout().get_params()
    assert {value for key, value in found.items() if "random_" in key} == {8}


@pytest.mark.parametrize("name", ["lstm", "fprc_best"])
def test_name_that_is_no_model_is_refused_with_those_that_are(name, models):
    with pytest.raises(ConfigError, match=f"'{name}'.* esn, fprc"):
        build(name, models, 1)


def test_unknown_setting_is_refused_by_name(models):
    with pytest.raises(ConfigError, match=r"trees .*'depth_'"):
        build("trees", models, 1, depth_=3)


def log(inputs):
    time = np.arange(400) / 20.0
    theta = 35.0 + 20.0 * np.sin(time)
    columns = {"theta_deg": theta, "p_o_kpa": 100.0 + 0.3 * theta + 2.0 * np.sin(time - 0.5)}
    return np.column_stack([columns[name] for name in inputs]), 175.0 + 120.0 * np.sin(time + 0.3)
