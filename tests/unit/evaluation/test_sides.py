import numpy as np
import pytest
from scipy.stats import gmean

from fprc.config import Settings
from fprc.evaluation import sides
from fprc.evaluation.sides import (
    SHIFTS,
    SIDES,
    Recordings,
    best_of_side,
    distances,
    error_when_shifted,
    period_of,
    shifts_of,
)

MODELS = Settings().model_dump(mode="json")["models"]


def recordings(*lengths, rate_hz=50.0, period_s=None, seed=0):
    """Return a slow angle, which may repeat, a target that follows it, and an unrelated P_o."""
    rng, size = np.random.default_rng(seed), sum(lengths)
    t = np.arange(size) / rate_hz
    angle = np.cumsum(rng.standard_normal(size)) / np.sqrt(rate_hz)
    if period_s:
        angle = np.sin(2 * np.pi * t / period_s) + np.sin(6 * np.pi * t / period_s)
    return Recordings(angle, np.cos(t), 3.0 * angle + rng.standard_normal(size), lengths, rate_hz)


@pytest.mark.parametrize(
    ("rate_hz", "size"), [(200, 4), (199.5, 4), (100, 2), (133.8, 2), (99, 1), (20, 1), (1000, 20)]
)
def test_samples_are_averaged_to_at_least_50_hz(rate_hz, size):
    given = recordings(1003, 410, rate_hz=rate_hz)
    thin = given.thinned()
    assert thin.rate_hz == pytest.approx(rate_hz / size)
    assert list(thin.lengths) == [1003 // size, 410 // size]
    assert thin.theta[1] == pytest.approx(given.theta[size : 2 * size].mean())
    assert thin.target[1003 // size] == pytest.approx(given.target[1003 : 1003 + size].mean())


def test_blocks_leave_out_the_first_seconds_of_each_recording():
    folds = recordings(3000, 1500).folds()
    judged = np.sort(np.concatenate([block for _, block in folds]))
    np.testing.assert_array_equal(judged, np.append(np.arange(250, 3000), np.arange(3250, 4500)))
    for train, block in folds:
        assert np.isin(train, judged).all()
        near = np.abs(train[:, None] - block[[0, -1]]).min(axis=1) <= 100
        same = (train < 3000) == (block[0] < 3000)
        assert not (near & same).any()


@pytest.mark.parametrize("period_s", [None, 7.0, 24.0])
def test_shifts_stay_away_from_none_and_from_periods(period_s):
    found = shifts_of(120.0, period_s)
    assert len(set(found)) == SHIFTS
    seconds = np.array(found) * 120.0
    assert seconds.min() >= 9.99
    assert 120.0 - seconds.max() >= 9.99
    if period_s:
        past = seconds % period_s
        away = min(10.0, period_s / 4) - 0.01
        assert np.minimum(past, period_s - past).min() >= away


@pytest.mark.parametrize("period_s", [3.0, 15.0, 24.0])
def test_period_is_that_of_the_motion(period_s):
    noise = np.random.default_rng(1).normal(size=5000)
    theta = recordings(5000, period_s=period_s).theta + 0.05 * noise
    assert period_of(theta) == pytest.approx(50.0 * period_s, abs=2.5)


def test_distance_is_the_share_that_does_not_come_back():
    noise = np.random.default_rng(2).standard_normal(6000)
    signal = 10.0 * np.sin(2.0 * np.pi * np.arange(6000) / 300.0) + 5.0 * noise
    assert distances(signal)[300] == pytest.approx(25.0 / 75.0, abs=0.03)


def test_motions_that_do_not_repeat_have_no_period():
    chirp = np.sin(np.arange(5000) ** 2 / 4e5)
    for theta in (chirp, recordings(5000).theta, np.linspace(0.0, 1.0, 5000), np.zeros(5000)):
        assert period_of(theta) is None


@pytest.fixture
def two_families(monkeypatch):
    """Compare two quick families only."""
    chosen = {name: SIDES[name] for name in ("taps", "low-passes")}
    monkeypatch.setattr(sides, "SIDES", chosen)


@pytest.mark.usefixtures("two_families")
def test_best_of_a_side_is_chosen_by_the_other_blocks_alone():
    given = recordings(3000)
    block = given.folds()[4][1]
    side = best_of_side(given, True, MODELS, 1)
    target = given.target.copy()
    target[block] += 100.0 * np.sin(np.arange(len(block)))
    other = best_of_side(given._replace(target=target), True, MODELS, 1)
    assert other.chosen[4] == side.chosen[4]
    assert other.errors[4] > 5.0 * side.errors[4]


@pytest.mark.usefixtures("two_families")
def test_equal_errors_take_the_plainest_family_and_the_largest_ridge():
    given = recordings(3000)  # the target is a straight line of theta
    side = best_of_side(given, False, MODELS, 1)
    assert {name for name, _ in side.chosen} == {"taps"}
    assert gmean(side.errors) == pytest.approx(1.0, rel=0.3)


@pytest.mark.usefixtures("two_families")
def test_shift_takes_away_what_p_o_tells():
    given = recordings(3000)
    load = 5.0 * recordings(3000, seed=1).theta
    told = given._replace(target=given.target + load, p_o=load)
    side = best_of_side(told, True, MODELS, 1)
    kept, moved = (error_when_shifted(told, share, side, MODELS, 1) for share in (0.0, 0.4))
    assert kept == pytest.approx(gmean(side.errors))
    assert kept < 0.5 * moved
