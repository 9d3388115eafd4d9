"""Faults of parts, in this process: the rig runs on its bench's clock, tick by tick."""

import errno
import math
import time
from types import SimpleNamespace

import numpy as np
import pytest
from bench import journal_at

from fprc.apparatus import command, guardian, journal, process
from fprc.apparatus.guardian import ARMED, HEARTBEAT, OPENING, SAFE
from fprc.errors import ControlError, FprcError
from fprc.logs import read_columns

TICKS = 8
_WRITE, _READ = "AioSingleAoEx", "AioMultiAiEx"
#: Every call of the driver in a run of eight ticks, by its part.
PARTS = {
    "opening the boards": [
        "AioInit", "AioResetDevice", "AioSetAoRangeAll", _WRITE, _WRITE,
        "AioInit", "AioResetDevice", "AioSetAiRangeAll",
    ],
    "a tick": [_READ, _WRITE, _WRITE] * TICKS,
    "venting at the end": [_WRITE] * 4,
    "venting until readings show it": [_WRITE, _WRITE, _READ] * 10,
    "releasing the boards": ["AioExit"] * 2,
}  # fmt: skip
OPEN, TICK, SAFELY, LOOK, EXIT = PARTS
CALLS = [(part, call) for part, calls in PARTS.items() for call in calls]


@pytest.fixture
def record(bench, settings, live_by, monkeypatch, tmp_path):
    """Record a few ticks of the sweep; ``at(tick)`` injects; return error, journal, sessions."""
    settings["experiments"]["sweep"]["duration_s"] = 2.0
    plan = process.plan

    def record(ticks=TICKS, *, at=lambda tick: None, law=None, **guarded):
        found = SimpleNamespace(raw=tmp_path / "sweep.h5", error=None)
        found.sessions, stand_in = live_by(bench, at, **guarded)

        def cut(*arguments):
            experiment = plan(*arguments)
            return experiment._replace(samples=ticks, law=law or experiment.law)

        monkeypatch.setattr(process, "plan", cut)
        try:
            process.record("sweep", str(found.raw), settings=settings, guardian=stand_in)
        except FprcError as error:
            found.error = error
        found.messages = stand_in.messages
        (path,) = tmp_path.glob("*.journal")
        vars(found).update(vars(journal_at(path)))
        assert (found.closed, found.lost) == (True, 0)
        for path in tmp_path.glob("*.h5"):  # what is in the journal is in the log too
            log = read_columns(path, ("time_s", "theta_deg"))
            assert len(log.channels["time_s"]) >= found.samples
        return found

    return record


def vented(bench):
    return list(bench.shared.outputs[:2]) == [0.0, 0.0]


def test_run_without_a_fault_makes_the_calls_that_are_tried_below(bench, record):
    found = record()
    assert found.error is None
    assert (bench.shared.calls, found.samples) == (len(CALLS), TICKS)
    assert found.raw.exists()
    assert [message for message in found.messages if message != HEARTBEAT] == [OPENING, ARMED, SAFE]
    assert vented(bench)


def test_chamber_that_keeps_its_pressure_is_not_called_vented(bench, record, settings):
    settings["hardware"]["boards"]["main_output"] = 3  # the valve does not hear
    bench.shared.outputs[0] = 5.5
    found = record()
    assert "THE CHAMBERS MAY BE UNDER PRESSURE" in str(found.error)
    assert "are vented" not in str(found.error)
    assert SAFE not in found.messages


@pytest.mark.parametrize("for_good", [False, True])
@pytest.mark.parametrize("at", range(len(CALLS)))
def test_call_of_the_driver_that_fails_ends_the_run_vented(bench, record, at, for_good):
    """Unless the board fails for good; then only the guardian can vent."""
    part, call = CALLS[at]
    shared = bench.shared
    bench.fail(1 << 40 if for_good else 1, skip=at)
    found = record()
    assert shared.failures == (shared.calls - at if for_good else 1)
    assert for_good or shared.failed == call.encode()
    healed = part == LOOK and not for_good
    assert (f"{call} failed with code 777" in str(found.error)) is not healed
    assert (f"{call} failed" in found.reason) is not healed
    last = found.sessions[-1]
    assert last.tick == last.clean_tick or healed
    # the sample of the tick in which the call failed was not complete
    assert found.samples == min(max(at - len(PARTS[OPEN]), 0) // 3, TICKS)
    assert found.raw.exists() is healed
    assert (found.messages[0], ARMED in found.messages) == (OPENING, part != OPEN)
    # without this message the guardian vents once more; before a run there is nothing to be vented
    assert (SAFE in found.messages) is (part == OPEN or (part != EXIT and not for_good))
    # nothing had moved before the first tick's writes, or it was vented already
    moved = at > len(PARTS[OPEN]) + 1 and part in (TICK, SAFELY)
    assert vented(bench) is not (for_good and moved)
    assert for_good or shared.opened == (0 if call != "AioExit" else 1)


@pytest.mark.parametrize("failures", [6, 12, 40])
def test_board_that_fails_for_a_moment_is_vented_as_soon_as_it_answers(bench, record, failures):
    bench.fail(failures, skip=len(PARTS[OPEN]) + 4 * 3)
    found = record()
    assert bench.shared.failures == failures
    assert vented(bench)
    assert SAFE in found.messages
    # written again before every reading, not only once the time to vent is over
    lost = bench.tick - found.sessions[-1].tick
    assert lost * bench.period_s < 0.02 * (failures + 15)


def bus(code, ticks=math.inf):
    """Return what sets a fault of the I2C bus for some ticks, from one on."""

    def make(bench, begin):
        def at(tick):
            bench.shared.i2c_fault = code if begin <= tick < begin + ticks else 0

        return {"at": at}

    return make


def pressure(sensor, change, ticks=1):
    """Return what changes the voltage of a pressure sensor, given that of the first such tick."""

    def make(bench, begin):
        held = []

        def at(tick):
            if begin <= tick < begin + ticks:
                held.append(bench.shared.inputs[sensor])
                bench.shared.inputs[sensor] = change(held[0])

        return {"at": at}

    return make


def controller(respond):
    def make(bench, begin):
        return {"law": lambda k, now: respond() if k == begin else (10.0, 0.0)}

    return make


def asked_to_stop(bench, begin):
    asked = []
    return {"at": asked.append, "stop": lambda: "SIGTERM" if asked[-1] == begin else ""}


def unexpected(bench, begin):
    def at(tick):
        if tick == begin:
            raise MemoryError

    return {"at": at}


WHICH = ("p_exp_kpa", "p_i_kpa", "p_o_kpa")
FROZEN, WRONG_TYPE, WRONG_ORDER = 2, 4, 5
#: What fails, at which tick, what the message names, and how many ticks later the run ends.
FAULTS = {
    "angle, one packet missing": (bus(1, 1), 20, "angle", 0),
    "angle, spike of 90 deg": (bus(3, 1), 20, "theta_deg", 0),
    "angle, packet cut short": (bus(6, 1), 20, "2 bytes, not 3", 0),
    "angle, frozen": (bus(FROZEN), 20, "theta_deg", 50),
    "angle, packets of a wrong type": (bus(WRONG_TYPE), 20, "theta_deg", 50),
    "angle, packets with their bytes in a wrong order": (bus(WRONG_ORDER), 20, "theta_deg", 50),
    **{
        f"{name}, {fault}": (pressure(sensor, change), 5, name, 0)
        for fault, change in (
            ("over its limit", lambda volts: 3.0),  # 500 kPa
            ("cable off", lambda volts: 0.0),
            ("spike of 100 kPa", lambda volts: volts + 0.4),
            ("no number", lambda volts: math.nan),
        )
        for sensor, name in enumerate(WHICH)
    },
    **{
        f"{name}, frozen": (pressure(sensor, lambda volts: volts, math.inf), 26, name, 51)
        for sensor, name in enumerate(WHICH)
    },
    "controller raises": (controller(lambda: 1 / 0), 5, "ZeroDivisionError", 0),
    "controller gives no number": (controller(lambda: (math.nan, 0.0)), 5, "", 0),
    "controller gives too few values": (controller(tuple), 5, "", 0),
    "stop is requested": (asked_to_stop, 5, "SIGTERM", 0),
    "unexpected exception": (unexpected, 5, "MemoryError", 0),
}


@pytest.mark.parametrize(("make", "begin", "message", "until"), FAULTS.values(), ids=FAULTS)
def test_part_that_fails_in_mid_run_ends_it_vented(bench, record, make, begin, message, until):
    found = record(200 if until else 100, **make(bench, begin))
    assert vented(bench)
    assert message in str(found.error)
    assert found.sessions[-1].tick == found.samples == begin + until


@pytest.mark.parametrize("code", [FROZEN, WRONG_TYPE, WRONG_ORDER])
def test_angle_that_stands_still_for_less_than_the_time_allowed_ends_no_run(bench, record, code):
    found = record(100, **bus(code, 40)(bench, 20))  # early in the sweep it does not move far
    assert (found.error, found.samples, vented(bench)) == (None, 100, True)
    assert len(np.unique(found.channels["theta_deg"][20:60])) < 5


def test_disk_that_is_full_ends_the_run_vented(bench, record, monkeypatch, tmp_path):
    write, written = journal._write, []

    def full(file, data):
        written.append(data)
        if len(written) == 7:  # the header, five samples, and this one
            raise OSError(errno.ENOSPC, "No space left on device")
        write(file, data)

    monkeypatch.setattr(journal, "_write", full)
    found = record()
    assert str(found.error).count("No space left on device") == 1
    assert vented(bench)
    assert (found.samples, found.sessions[-1].tick) == (5, 5)
    (rescued,) = tmp_path.glob("*.rescued.h5")
    assert len(read_columns(rescued, ("time_s",)).channels["time_s"]) == 6


@pytest.mark.parametrize("armed", [True, False])
def test_log_that_is_there_and_a_rig_that_is_not_armed_are_not_touched(
    bench, tmp_path, settings, armed
):
    raw = tmp_path / "logs" / "sweep.h5"
    if armed:
        raw.parent.mkdir()
        raw.write_bytes(b"mine")
    refusal = FprcError if armed else ControlError
    with pytest.raises(refusal, match="exists" if armed else "not armed, nothing was moved"):
        command.record(str(raw), name="sweep", settings=settings, armed=armed)
    assert bench.shared.calls == 0
    assert raw.parent.exists() is armed
    assert not armed or [path.read_bytes() for path in raw.parent.iterdir()] == [b"mine"]


def test_reason_of_a_run_is_kept_when_the_rig_cannot_be_closed_either(bench, record):
    found = record(**bus(1)(bench, 5))
    for text in (str(found.error), found.reason):
        assert "run stopped at sample 5: angle sensor 0x12: reading the angle failed" in text
        assert "stopping it failed" in text


def test_loop_whose_guardian_has_ended_vents_until_the_board_answers(
    bench, settings, record, monkeypatch
):
    settings["hardware"]["valves"]["vent_s"] = 0.4
    passes = SimpleNamespace(sleep=bench.wait, monotonic=time.monotonic)
    monkeypatch.setattr(guardian, "time", passes)
    monkeypatch.setattr(guardian, "_RETRY_S", 0.005)

    def fail(tick):
        if tick == 5:
            bench.fail(120)

    found = record(at=fail, guarded=False)
    assert bench.shared.failures == 120
    assert vented(bench)
    assert "both chambers are vented" in found.reason
    assert found.samples == 5
