"""The verdict on a recording, memory of P_o, and the claims B1, B4 and R1."""

import math

import numpy as np
import pytest

from fprc.config import Settings
from fprc.evaluation.sides import Recordings
from fprc.recordings import answer
from fprc.recordings.answer import CLAIMS, MODELS, decide, first_line, judge_claims
from tests.reference.worlds import WORLDS, play, slow, verdict


def found(low=0.7, ratio=0.8, high=0.9, beaten=19, period_s=None, new=None, **changed):
    """Return what a comparison found: errors of 4 with P_o, and of 5 without."""
    return {
        "low": low, "ratio": ratio, "high": high,
        "with": {"error": 4.0, "family": "plays"}, "without": {"error": 5.0, "family": "fuzzy"},
        "shifts": [5.0] * beaten + [3.0] * (19 - beaten),
        "period_s": period_s, "new": new, "explained": 0.9, "duration_s": 120.0,
    } | changed  # fmt: skip


CLEAR = {"low": 0.7, "ratio": 0.8, "high": 0.9}
WIDE = {"low": 0.7, "ratio": 0.85, "high": 1.03}
ODD = {"low": 0.5, "ratio": 0.95, "high": 1.8}
ABOVE = {"low": 0.96, "ratio": 1.0, "high": 1.04}


@pytest.mark.parametrize(
    ("given", "verdict", "reason"),
    [
        (CLEAR, "Yes", ""),
        ({**CLEAR, "high": 0.96}, "Not decided", "too short"),
        ({**CLEAR, "beaten": 18}, "Not decided", "another time"),
        ({**CLEAR, "shifts": []}, "Not decided", "another time"),
        ({**CLEAR, "beaten": 18, "period_s": 15.0}, "Not decided", "every 15 s"),
        ({**CLEAR, "period_s": 15.0, "new": 0.1}, "Not decided", "every 15 s"),
        ({**CLEAR, "period_s": 15.0}, "Yes", ""),
        (ABOVE, "No", ""),
        ({**ABOVE, "beaten": 0, "period_s": 15.0}, "No", ""),
        ({"low": 1.1, "ratio": 1.2, "high": 1.3}, "No", ""),
        (WIDE, "Not decided", "too short"),
        ({**WIDE, "period_s": 15.0}, "Not decided", "every 15 s"),
        ({**WIDE, "explained": 0.17}, "Not decided", "17 %"),
        (ODD, "Not decided", "disagree"),
    ],
)
def test_verdict_and_the_reason_that_matters_most(given, verdict, reason):
    got, why, _ = decide(found(**given), np.log(np.linspace(0.7, 1.1, 20)))
    assert got == verdict
    assert bool(why) == bool(reason)
    assert reason in why


def test_few_blocks_decide_nothing():
    got, why, needed_s = decide(found(), [-0.2] * 7)
    assert (got, needed_s) == ("Not decided", 53.0)
    assert "53 s" in why


def test_length_that_would_decide_comes_from_the_spread():
    """Half of the interval falls with the root of the length, to the distance to the margin."""
    _, why, needed_s = decide(found(**WIDE), [0.0] * 20)
    half, away = np.log(1.03 / 0.85), -np.log(0.85) - np.log(1.05)
    assert needed_s == pytest.approx(120.0 * (half / away) ** 2)
    assert f"{int(np.ceil(needed_s / 60))} minutes" in why


def test_first_line_names_both_sides():
    line = first_line(found() | {"verdict": "Yes", "reason": ""}, "N")
    assert line == "Yes: with P_o 4.00 N (plays + P_o), without 5.00 (FPRC on low-passed theta)."


@pytest.mark.slow
@pytest.mark.parametrize("name", WORLDS)
def test_made_worlds_get_the_right_answer_at_any_rate(name):
    verdicts = {verdict(name, 1, recorded_hz=200.0, each=each) for each in (1, 2, 4)}
    assert verdicts <= set(WORLDS[name])
    assert not {"Yes", "No"} <= verdicts


SETTINGS = Settings().model_dump(mode="json")["models"]
SIZE, RATE_HZ = 6000, 50.0
RNG = np.random.default_rng(0)
THETA = 30.0 + 10.0 * slow(RNG, SIZE, RATE_HZ, 1.0)
NOISE = RNG.standard_normal(SIZE)


def judged(p_o):
    return answer.judge_memory(Recordings(THETA, p_o, THETA, [SIZE], RATE_HZ), SETTINGS, 1)


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
    parts = judged(p_o)
    if linear is None:  # backlash is more than a filter
        assert parts["linear"] < 0.9
        assert parts["hysteresis"] > 0.9 * (1.0 - parts["linear"])
    else:
        assert parts["linear"] == pytest.approx(linear, abs=0.05)
        assert parts["hysteresis"] == pytest.approx(hysteresis, abs=0.02)


def test_delayed_theta_is_remembered_beyond_what_its_low_passes_remember():
    found = judged(np.roll(THETA, 100) + 0.1 * NOISE)
    assert found["p_o"]["lags_s"][int(np.argmax(found["p_o"]["memory"]))] == pytest.approx(2.0)
    assert found["p_o"]["memory_s"] > 1.2 * found["theta"]["memory_s"]
    own = judged(THETA)
    assert own["p_o"] == own["theta"]


def cells(blocks=10, spread=0.01, **ratios):
    """Return errors of 10 on each block, those of FPRC by a ratio to each other model."""
    noise = np.random.default_rng(2).standard_normal((len(MODELS), blocks))
    return {
        name: list(10.0 / ratios.get(name, 1.0) * np.exp(spread * own))
        for name, own in zip(MODELS, noise, strict=True)
    }


def test_ratio_and_interval_are_those_of_the_corrected_t_test_after_holm():
    given = cells(spread=0.1)
    row = judge_claims(given, 1 / 9)[0]
    ratios = np.log(given["fprc"]) - np.log(given[CLAIMS["B1"][1]])
    assert row["mean"] == pytest.approx(math.exp(ratios.mean()))
    assert row["level"] == pytest.approx(0.05 / 3)  # nothing is decided
    half = 2.9333 * math.sqrt((1 / 10 + 1 / 9) * ratios.var(ddof=1))
    assert math.log(row["high"] / row["mean"]) == pytest.approx(half, rel=1e-4)


def test_model_without_errors_leaves_its_claim_unjudged():
    given = cells(fprc_lowpass=0.7)
    del given["ridge_p_o"]
    rows = judge_claims(given, 1 / 9)
    assert [row["verdict"] for row in rows] == ["superior", "not judged", "equivalent"]
    few = judge_claims(cells(7, spread=0.1), 1 / 9)
    assert [row["verdict"] for row in few] == ["undecided"] * 3


def test_network_of_too_many_samples_is_left_out(seen, monkeypatch):
    monkeypatch.setattr(answer, "MOST_OF_ESN", 3999)
    channels = (seen["sweep"][name] for name in ("theta_deg", "p_o_kpa", "p_target_kpa"))
    found = answer.judge_models(Recordings(*channels, [4000], 100.0), SETTINGS, 1)
    assert [*found] == [name for name in MODELS if name != "esn"]
    assert all(len(blocks) == 5 for blocks in found.values())
