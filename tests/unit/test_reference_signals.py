import numpy as np
import pytest

from fprc.config import Settings
from fprc.signals import random_pushes, reference_angle

RATE_HZ = 200.0
PUBLISHED_HZ = (0.12, 0.04, 0.31, 0.29, 0.25)


@pytest.fixture(scope="module")
def references():
    return Settings().tracking.references.model_dump()


def moving(reference):
    """Times and angles after the settling part."""
    theta_d = reference_angle(reference, RATE_HZ)[round(reference["settle_s"] * RATE_HZ) :]
    return np.arange(len(theta_d)) / RATE_HZ, theta_d


def test_sweep_is_the_printed_formula(references):
    t, theta_d = moving(references["sweep"])
    expected = 27.5 * np.sin(np.pi * t * (0.01125 * t + 0.1) - 0.5 * np.pi) + 32.5
    assert len(t) == 80 * 200
    np.testing.assert_allclose(theta_d, expected, atol=1e-9)


def test_complex_is_the_printed_formula(references):
    t, theta_d = moving(references["complex"])
    sines = [np.sin(2.0 * np.pi * f * t - np.pi / 2.0) for f in PUBLISHED_HZ]
    assert len(t) == 100 * 200
    np.testing.assert_allclose(theta_d, 6.5 * sum(sines) + 40.5, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "f_hz"), [("sine_0p2", 0.2), ("sine_0p5", 0.5), ("disturbance", 0.3)]
)
def test_sine_has_the_frequency_of_its_name(references, name, f_hz):
    t, theta_d = moving(references[name])
    np.testing.assert_allclose(theta_d, 32.5 - 27.5 * np.cos(2.0 * np.pi * f_hz * t), atol=1e-9)


@pytest.mark.parametrize("name", ["sine_0p2", "sine_0p5", "sweep", "complex", "disturbance"])
@pytest.mark.parametrize("settle_s", [0.0, 1.5, 5.0])
def test_settling_part_holds_the_lowest_value_before_the_reference(references, name, settle_s):
    reference = references[name] | {"settle_s": settle_s}
    theta_d = reference_angle(reference, RATE_HZ)
    settling = round(settle_s * RATE_HZ)
    assert len(theta_d) == settling + round(reference["duration_s"] * RATE_HZ)
    np.testing.assert_array_equal(theta_d[:settling], theta_d.min())
    assert theta_d[settling] == theta_d.min()
    assert theta_d[settling + 1] > theta_d.min()


def pushes(seed=1, samples=8000, **changed):
    settings = {"quiet_s": 12.0, "every_s": 1.2, "sigma_kpa": 150.0} | changed
    return random_pushes(samples, RATE_HZ, rng=np.random.default_rng(seed), **settings)


@pytest.mark.parametrize("quiet_s", [0.5, 12.0, 39.0])
def test_nothing_is_pushed_before_the_quiet_time_is_over(quiet_s):
    force = pushes(quiet_s=quiet_s)
    begin = round(quiet_s * RATE_HZ)
    assert len(force) == 8000
    assert not force[: begin + 1].any()
    assert np.abs(force[begin + 1 : begin + 40]).min() > 0.0


def test_pushes_are_the_same_for_a_seed_and_others_for_another():
    np.testing.assert_array_equal(pushes(seed=3), pushes(seed=3))
    assert np.abs(pushes(seed=3) - pushes(seed=4)).max() > 10.0


def test_size_of_pushes_scales_with_sigma():
    np.testing.assert_allclose(pushes(sigma_kpa=300.0), 2.0 * pushes(sigma_kpa=150.0))
    assert not pushes(sigma_kpa=0.0).any()


def test_single_push_is_a_half_sine_of_0p2_to_1_s():
    lengths = []
    for seed in range(30):
        force = pushes(seed, samples=400, quiet_s=0.5, every_s=1e9)
        inside = np.flatnonzero(force)
        lengths.append(len(inside) / RATE_HZ)
        assert inside[0] == 101
        assert len(inside) == inside[-1] - inside[0] + 1
        shape = np.sin(np.pi * (inside - 100) / RATE_HZ / lengths[-1])
        np.testing.assert_allclose(
            force[inside] / force[inside[len(inside) // 2]], shape, atol=0.08
        )
    assert 0.18 < min(lengths) < 0.4
    assert 0.8 < max(lengths) < 1.02


def test_pushes_begin_as_often_as_asked():
    """Steps of the slope of the force count them: half sines begin with a jump in slope."""
    force = pushes(samples=400_000, quiet_s=0.0, every_s=5.0)
    begins = (force[1:] != 0.0) & (force[:-1] == 0.0)
    assert begins.sum() == pytest.approx(2000.0 / 5.0, rel=0.25)


def test_record_that_ends_before_the_quiet_time_is_quiet():
    assert not pushes(samples=2400).any()
