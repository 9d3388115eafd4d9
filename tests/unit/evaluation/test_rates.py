"""Settings in samples at another rate: the same responses at the same times."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.config import Settings
from fprc.evaluation.sides import models_at, scaled
from fprc.models import LowpassBank

MODELS = Settings().model_dump(mode="json")["models"]


@given(st.floats(1e-5, 1.0), st.integers(2, 20), st.booleans())
def test_step_response_of_the_lowpass_keeps_its_times(epsilon, factor, faster):
    ratio = float(factor) if faster else 1.0 / factor
    (new,) = scaled({"epsilon": epsilon}, ratio).values()
    # factor samples of the faster rate are one of the slower
    slower, quicker = (epsilon, new) if faster else (new, epsilon)
    step = np.append(0.0, np.ones(40 * factor))[:, None]
    fine = LowpassBank([quicker]).fit_transform(step)[::factor]
    coarse = LowpassBank([slower]).fit_transform(step[:41])
    np.testing.assert_allclose(fine, coarse, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(
    ("ratio", "expected"),
    [
        (0.5, {"washout": 50, "spacing": 12, "epsilons": [1.0, 0.0199], "gamma": 0.81}),
        (0.01, {"washout": 1, "spacing": 1, "epsilons": [1.0, 1.0 - 0.99**100],
                "gamma": 0.9**100}),
        (2.0, {"washout": 200, "spacing": 50, "epsilons": [1.0, 1.0 - 0.99**0.5],
               "gamma": 0.9**0.5}),
        (1.0, {}),
    ],
)  # fmt: skip
def test_counts_are_scaled_and_taps_are_not(ratio, expected):
    own = {
        "washout": 100,
        "spacing": 25,
        "epsilons": [1.0, 0.01],
        "gamma": 0.9,
        "n_taps": 5,
        "n_y": 5,
    }
    assert scaled(own, ratio) == {
        name: pytest.approx(value, rel=1e-12) for name, value in expected.items()
    }
    assert scaled({"washout": 0}, 0.5) == {"washout": 0}


def test_models_of_the_configuration_are_scaled():
    fprc = MODELS["fprc"] | {"epsilon": pytest.approx(0.0199)}
    esn = MODELS["esn"] | {"gamma": pytest.approx(0.64), "washout": 50}
    assert models_at(MODELS, 0.5) == MODELS | {"fprc": fprc, "esn": esn}
    assert models_at(MODELS, 1.0) == MODELS
