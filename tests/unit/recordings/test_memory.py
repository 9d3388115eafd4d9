import numpy as np
import pytest

from fprc.config import Settings
from fprc.evaluation.sides import Recordings
from fprc.recordings.memory import judge_memory, memory_in_words
from tests.reference.worlds import play, slow

MODELS = Settings().model_dump(mode="json")["models"]
SIZE, RATE_HZ = 6000, 50.0
RNG = np.random.default_rng(0)
THETA = 30.0 + 10.0 * slow(RNG, SIZE, RATE_HZ, 1.0)
NOISE = RNG.standard_normal(SIZE)


def judged(p_o, theta=THETA, period_s=None):
    given = Recordings(theta, p_o, theta, [len(theta)], RATE_HZ)
    return judge_memory(given, MODELS, 1, period_s)


@pytest.mark.parametrize(
    ("p_o", "linear", "hysteresis"),
    [
        (2.0 * THETA, 1.0, 0.0),
        (play(THETA, 9.0), None, None),
        (10.0 * NOISE, 0.0, 0.0),
        (THETA + 10.0 * NOISE, 0.5, 0.0),
    ],
)
def test_parts_of_p_o_are_those_it_was_made_of(p_o, linear, hysteresis):
    parts = judged(p_o)["parts"]
    if linear is None:  # backlash is more than a filter
        assert parts["linear"] < 0.9
        assert parts["hysteresis"] > 0.9 * (1.0 - parts["linear"])
    else:
        assert parts["linear"] == pytest.approx(linear, abs=0.05)
        assert parts["hysteresis"] == pytest.approx(hysteresis, abs=0.02)
    assert parts["new"] is None


def test_delayed_theta_is_remembered_beyond_what_its_low_passes_remember():
    found = judged(np.roll(THETA, 100) + 0.1 * NOISE)
    assert found["lags_s"][int(np.argmax(found["p_o"]["memory"]))] == pytest.approx(2.0)
    assert found["p_o"]["memory_s"] > 1.2 * found["theta"]["memory_s"]
    own = judged(THETA)
    assert own["p_o"] == own["theta"]


def test_what_does_not_come_back_with_the_motion_is_new():
    theta = 30.0 + 10.0 * np.sin(2 * np.pi * np.arange(SIZE) / RATE_HZ / 6.0)
    found = judged(theta + 5.0 * NOISE, theta, 6.0)
    assert found["parts"]["new"] == pytest.approx(25.0 / 75.0, abs=0.03)
    assert len(memory_in_words(found)) == 3
