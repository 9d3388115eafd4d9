"""The verdict on a recording, from numbers, and on made worlds."""

import numpy as np
import pytest

from fprc.recordings.answer import decide, first_line
from tests.reference.worlds import WORLDS, verdict


def found(low=0.7, ratio=0.8, high=0.9, beaten=19, period_s=None, repeats=False, **changed):
    """Return what a comparison found: errors of 4 with P_o, and of 5 without."""
    return {
        "low": low, "ratio": ratio, "high": high,
        "with": {"error": 4.0, "family": "plays"}, "without": {"error": 5.0, "family": "fuzzy"},
        "shifts": [5.0] * beaten + [3.0] * (19 - beaten),
        "period_s": period_s, "p_o_repeats": repeats, "explained": 0.9, "duration_s": 120.0,
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
        ({**CLEAR, "period_s": 15.0, "repeats": True}, "Not decided", "every 15 s"),
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
