"""The one judge of a recording: what is doubtful, and what stops an answer."""

from pathlib import Path

import numpy as np
import pytest

from fprc.config.settings import Quality
from fprc.recordings.import_recording import judge, unfit
from fprc.recordings.importing import ImportMap, Recording
from fprc.recordings.table import Column, Table

SIZE, RATE_HZ = 3000, 50.0
T = np.arange(SIZE) / RATE_HZ
ANGLE = 30.0 + 20.0 * np.sin(T) + 5.0 * np.sin(2.3 * T)
PRESSURE = 4.0 * ANGLE + 10.0 * np.sin(7.1 * T)
MEMORY = 100.0 + 10.0 * np.sin(0.4 * T)
NOISE = np.random.default_rng(0).standard_normal(SIZE)
FORCE = {"unit": "1", "note": "force [N]"}


def judged(theta=ANGLE, p_o=MEMORY, p_exp=PRESSURE, time_s=T, column="p", beside="", **spec):
    """Judge channels, of which P_exp is a column with a unit beside it, and an entry in a map.

    What theta explains is looked at if nothing else stops the answer, as the command does.
    """
    columns = {"a": Column(theta), column: Column(p_exp, beside), "o": Column(p_o)}
    names = dict(zip(columns, ("theta_deg", "p_exp_kpa", "p_o_kpa"), strict=True))
    entries = {names[n]: {"column": n, "unit": "deg" if n == "a" else "kPa"} for n in columns}
    entries["p_exp_kpa"] |= spec
    mapping = ImportMap.model_validate({"time": {"rate_hz": 50}, "channels": entries})
    recording = Recording(time_s, {names[n]: column.values for n, column in columns.items()})
    table = Table(Path("log.csv"), "", columns, {})
    _, doubts, stops = judge(recording, mapping, table, Quality(), "measured")
    return doubts, stops or unfit(recording, "measured")


@pytest.mark.parametrize(
    "changed",
    [
        {},
        {"p_o": ANGLE + NOISE},  # a copy with noise gets an answer
        {"p_o": PRESSURE + 10.0 * NOISE},
        {"theta": np.where(np.arange(SIZE) < 20, 500.0, ANGLE)},  # fewer than 1 % out of range
        {"p_exp": PRESSURE / 100.0, **FORCE},
        {"p_exp": 4.0 * np.abs(ANGLE - 30.0)},
        {"theta": np.where(T < 40.0, ANGLE, ANGLE[2000])},
        {"column": "p [bar]", "unit": "bar", "p_exp": PRESSURE},
        {"column": "p [bar]", "note": "the header is wrong"},
        {"column": "p [bar]", **FORCE},
    ],
)
def test_recordings_that_can_be_judged_pass(changed):
    assert judged(**changed)[1] == []


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"theta": np.full(SIZE, 3.0)}, "theta stands still"),
        ({"p_o": np.where(T < 35.0, MEMORY[0], MEMORY)}, "P_o stands still"),
        ({"p_exp": PRESSURE / 100.0}, "P_exp spans"),
        ({"theta": np.deg2rad(ANGLE)}, "theta spans"),
        ({"theta": np.where(np.arange(SIZE) < 40, 500.0, ANGLE)}, "theta_deg: 40 samples"),
        ({"p_o": ANGLE}, "theta and"),
        ({"p_o": 203.0 - 2.0 * ANGLE}, "theta and"),
        ({"p_o": np.roll(PRESSURE, 10)}, "P_o and P_exp are one"),
        ({"p_exp": 4.0 * ANGLE}, "theta and"),
        ({"p_exp": 100.0 + 30.0 * NOISE}, "next to nothing"),
        ({"time_s": 100.0 * T}, "0.5 Hz are unusual"),
        ({"time_s": T / 20.0, "p_exp": np.where(np.arange(SIZE) % 20 == 7, 50.0, 0.0)}, "nothing"),
        ({"column": "p [bar]"}, "channels.p_exp_kpa: the file says bar"),
        ({"column": "p", "beside": "bar"}, "channels.p_exp_kpa: the file says bar"),
    ],
)
def test_recordings_that_cannot_be_judged_stop(changed, words):
    assert any(words in line for line in judged(**changed)[1])


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"p_exp": np.where(T == 10.0, 1200.0, PRESSURE)}, ["range: channel p_exp_kpa"]),
        ({"theta": np.where(T < 5.0, 30.0, ANGLE)}, ["stuck: channel theta_deg"]),
        ({"p_exp": 0.2 + PRESSURE / 100.0}, ["is p in bar or psi?"]),
        ({"p_exp": PRESSURE / 100.0, "scale": 100.0}, []),
        ({}, []),
    ],
)
def test_what_a_person_should_look_at_is_doubtful(changed, words):
    doubts = judged(**changed)[0]
    assert len(doubts) == len(words)
    assert all(word in line for word, line in zip(words, doubts, strict=True))
