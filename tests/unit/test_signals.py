import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import signal

from fprc.config import Settings
from fprc.signals import (
    chirp,
    loop_width,
    multisine,
    pressure_command,
    random_pushes,
    reference_angle,
)

COMPLEX = Settings().experiments.complex


@given(st.floats(1.0, 200.0), st.floats(0.01, 2.0), st.floats(0.01, 2.0), st.floats(0.0, 200.0))
def test_chirp_agrees_with_scipy(duration_s, f_start_hz, f_end_hz, amplitude):
    t = np.linspace(0.0, duration_s, 200)
    ours = chirp(t, (f_start_hz, f_end_hz), duration_s, amplitude, 175.0)
    theirs = signal.chirp(t, f_start_hz, duration_s, f_end_hz, method="linear", phi=180.0)
    np.testing.assert_allclose(ours, 175.0 + amplitude * theirs, atol=1e-8 * (1.0 + amplitude))


def test_multisine_is_the_papers_complex_signal():
    t = np.arange(16_000) / 200.0
    printed = 175.0 + sum(35.0 * np.sin(2.0 * np.pi * f * t - 0.5 * np.pi) for f in F_HZ)
    ours = multisine(t, F_HZ, 35.0, 175.0)
    np.testing.assert_allclose(ours, printed, atol=1e-9)
    np.testing.assert_allclose(pressure_command(COMPLEX, 200.0), printed, atol=1e-9)


F_HZ = (0.12, 0.04, 0.31, 0.29, 0.25)
REFERENCES = {
    "sine_0p2": lambda t: 32.5 - 27.5 * np.cos(2.0 * np.pi * 0.2 * t),
    "sine_0p5": lambda t: 32.5 - 27.5 * np.cos(2.0 * np.pi * 0.5 * t),
    "disturbance": lambda t: 32.5 - 27.5 * np.cos(2.0 * np.pi * 0.3 * t),
    "sweep": lambda t: 27.5 * np.sin(np.pi * t * (0.01125 * t + 0.1) - 0.5 * np.pi) + 32.5,
    "complex": lambda t: 40.5 + 6.5 * sum(np.sin(2.0 * np.pi * f * t - 0.5 * np.pi) for f in F_HZ),
}


@pytest.mark.parametrize("name", REFERENCES)
def test_reference_is_the_printed_angle_after_settling(name):
    reference = Settings().tracking.reference(name).changed(settle_s=5.0)
    angle = reference_angle(reference, 200.0)
    printed = REFERENCES[name](np.arange(round(200.0 * reference.duration_s)) / 200.0)
    np.testing.assert_allclose(angle[1000:], printed, atol=1e-9)
    np.testing.assert_array_equal(angle[:1000], angle[1000])
    assert angle.min() == pytest.approx(angle[0], abs=1e-6)


def pushes(seed=0, samples=400_000, **changed):
    options = {"quiet_s": 12.0, "every_s": 3.0, "sigma_kpa": 150.0} | changed
    return random_pushes(samples, 200.0, **options, rng=np.random.default_rng(seed))


def test_pushes_spare_the_quiet_time_and_are_repeatable():
    force = pushes(samples=20_000)
    assert not force[: 12 * 200].any()
    assert force[12 * 200 :].any()
    np.testing.assert_array_equal(force, pushes(samples=20_000))
    assert not np.array_equal(force, pushes(seed=1, samples=20_000))


@pytest.mark.parametrize("seed", range(10))
def test_single_push_is_a_half_sine_of_0p2_to_1_s(seed):
    force = pushes(seed, samples=400, quiet_s=0.5, every_s=1e9)
    inside = np.flatnonzero(force)
    assert inside.tolist() == list(range(101, 101 + len(inside)))
    length = len(inside) / 200.0
    assert 0.18 < length < 1.02
    shape = np.sin(np.pi * (inside - 100) / 200.0 / length)
    np.testing.assert_allclose(force[inside] / force[inside[len(inside) // 2]], shape, atol=0.08)


@given(st.floats(0.0, 0.4), st.integers(100, 800))
def test_width_of_a_backlash_is_its_play(play, samples):
    """The output of a play operator is ``play / 2`` behind its input, rising and falling."""
    leg = np.linspace(0.0, 1.0, samples, endpoint=False)
    x = np.tile(np.concatenate([leg, 1.0 - leg]), 6)
    y = np.empty_like(x)
    held = 0.0
    for k, value in enumerate(x):
        held = min(max(held, value - play / 2), value + play / 2)
        y[k] = held
    assert loop_width(x, y) == pytest.approx(play, abs=1e-9)


def test_width_is_taken_half_way_and_not_at_the_mean():
    """The loop is ``2 (0.25 - x)**2`` wide at x."""
    time = np.arange(8000) / 200.0
    x = 0.25 * (1.0 - np.cos(0.8 * np.pi * time)) ** 2 - 0.5  # from -0.5 to 0.5, mean -0.125
    lens = np.sign(np.sin(0.8 * np.pi * time)) * (0.25 - x) ** 2
    assert loop_width(x, lens) == pytest.approx(2.0 * 0.0625, rel=0.01)
