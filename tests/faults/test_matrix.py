"""Faults of parts, in this process: the rig runs on its bench's clock, tick by tick."""

import errno
import logging
import math
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from fprc.apparatus import guardian, journal, pneumatics, process
from fprc.apparatus.guardian import ARMED, HEARTBEAT, OPENING, SAFE
from fprc.apparatus.record_on_rig import record_on_rig
from fprc.apparatus.recovery import read_journal
from fprc.errors import ControlError, FprcError, OutputError
from fprc.logs import read_columns

TICKS = 8
VENTED = [0.0, 0.0]
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
def record(bench, settings, live_by, asking, monkeypatch, tmp_path):
    """Record a few ticks of the sweep; ``at(tick)`` injects; return error, journal, sessions."""
    settings["experiments"]["sweep"]["duration_s"] = 2.0
    plan = process.plan

    def record(ticks=TICKS, *, at=lambda tick: None, law=None, stop=None):
        found = SimpleNamespace(raw=tmp_path / "sweep.h5", error=None)
        found.sessions, found.messages = live_by(bench, at)

        def cut(*arguments):
            experiment = plan(*arguments)
            return experiment._replace(samples=ticks, law=law or experiment.law)

        monkeypatch.setattr(process, "plan", cut)
        try:
            process.record("sweep", str(found.raw), settings=settings, stop=stop or asking())
        except FprcError as error:
            found.error = error
        (path,) = tmp_path.glob("*.journal")
        found.channels, _, findings = read_journal(path)
        found.samples, found.reason = findings.samples, findings.reason
        assert (findings.closed, findings.lost) == (True, 0)
        for path in tmp_path.glob("*.h5"):  # what is in the journal is in the log too
            log = read_columns(path, ("time_s", "theta_deg"))
            assert len(log.channels["time_s"]) >= found.samples
        return found

    return record


def vented(bench):
    return list(bench.shared.outputs[:2]) == VENTED


def test_run_without_a_fault_makes_the_calls_that_are_tried_below(bench, record):
    found = record()
    assert found.error is None
    assert (bench.shared.calls, found.samples) == (len(CALLS), TICKS)
    assert found.raw.exists()
    assert [message for message in found.messages if message != HEARTBEAT] == [OPENING, ARMED, SAFE]
    assert vented(bench)


def test_chamber_that_keeps_its_pressure_is_not_called_vented(bench, record, matrix, settings):
    settings["hardware"]["boards"]["main_output"] = 3  # the valve does not hear
    bench.shared.outputs[0] = 5.5
    found = record()
    assert "THE CHAMBERS MAY BE UNDER PRESSURE" in str(found.error)
    assert "are vented" not in str(found.error)
    assert SAFE not in found.messages
    matrix.add("a valve stays open", "no reading shows that it vents",
               "no: the guardian tries, then says what to do by hand")  # fmt: skip


def samples_before(at):
    """Return the samples that are complete when a call fails."""
    return min(max(at - len(PARTS[OPEN]), 0) // 3, TICKS)


ENDS = {OPEN: "the run does not start", LOOK: "nothing: it is retried"}


@pytest.mark.parametrize("at", range(len(CALLS)))
def test_call_of_the_driver_that_fails_once_ends_the_run_vented(bench, record, matrix, at):
    part, call = CALLS[at]
    shared = bench.shared
    bench.fail(skip=at)
    found = record()
    assert (shared.failures, shared.failed) == (1, call.encode())
    healed = part == LOOK
    assert (f"{call} failed with code 777 (injected failure)" in str(found.error)) is not healed
    assert (f"{call} failed" in found.reason) is not healed
    assert vented(bench)
    last = found.sessions[-1]
    assert last.tick == last.clean_tick or healed
    # the sample of the tick in which the call failed was not complete
    assert found.samples == samples_before(at)
    assert found.raw.exists() is healed
    # without this message the guardian vents once more
    assert (found.messages[0], SAFE in found.messages) == (OPENING, part != EXIT)
    assert (ARMED in found.messages) is (part != OPEN)
    assert shared.opened == (0 if call != "AioExit" else 1)
    ends = ENDS.get(part, "the driver's error")
    matrix.add(f"a driver call fails once: {part}", ends, ticks="-" if healed else 0)


@pytest.mark.parametrize("at", range(len(CALLS)))
def test_board_that_fails_for_good_ends_the_run_without_the_message_safe(bench, record, matrix, at):
    part, call = CALLS[at]
    shared = bench.shared
    bench.fail(1 << 40, skip=at)
    found = record()
    assert shared.failures == shared.calls - at
    assert f"{call} failed with code 777" in str(found.error)
    last = found.sessions[-1]
    assert last.tick == last.clean_tick
    assert found.samples == samples_before(at)
    # before a run there is nothing to be made safe
    assert (SAFE in found.messages) is (part == OPEN)
    # nothing had moved before the first tick's writes, or it was vented already
    moved = at > len(PARTS[OPEN]) + 1 and part in (TICK, SAFELY)
    assert vented(bench) is not moved
    fault = f"every driver call fails from then on: {part}"
    if moved:
        matrix.add(fault, "the driver's error", "no: the guardian tries until it succeeds")
    else:
        matrix.add(fault, "the run does not start" if part == OPEN else "the driver's error",
                   ticks=0)  # fmt: skip


@pytest.mark.parametrize("failures", [6, 12, 40])
def test_board_that_fails_for_a_moment_is_vented_as_soon_as_it_answers(
    bench, record, matrix, failures
):
    bench.fail(failures, skip=len(PARTS[OPEN]) + 4 * 3)
    found = record()
    assert bench.shared.failures == failures
    assert vented(bench)
    assert SAFE in found.messages
    # written again before every reading, not only once the time to vent is over
    lost = bench.tick - found.sessions[-1].tick
    assert lost * bench.period_s < 0.02 * (failures + 15)
    matrix.add("the board fails for a moment", "the driver's error", "yes, once it answers")


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

    def stop():
        return "stopped by SIGTERM" if asked[-1] == begin else ""

    stop.guarded = lambda: True
    return {"at": asked.append, "stop": stop}


def unexpected(bench, begin):
    def at(tick):
        if tick == begin:
            raise MemoryError

    return {"at": at}


PRESSURES = ("p_exp_kpa", "p_i_kpa", "p_o_kpa")
REJECTED, FROZEN, GOES_ON = "a rejected reading", "frozen sensor", "nothing: the run continues"
FAILED = "the controller's error"
WRONG_TYPE, WRONG_ORDER = "packets of the wrong type", "packets with their bytes in the wrong order"
#: What fails, how, at which tick, the message, what ends the run, and how many ticks later.
FAULTS = [
    ("angle sensor: dropout, one packet", bus(1, 1), 20, "angle", REJECTED, 0),
    ("angle sensor: spike of +90 deg, one packet", bus(3, 1), 20, "theta_deg", REJECTED, 0),
    ("angle sensor: packet cut short, once", bus(6, 1), 20, "2 bytes, not 3", REJECTED, 0),
    *[
        (f"angle sensor: {fault}", bus(code), 20, "theta_deg", FROZEN, 50)
        for code, fault in ((2, "frozen"), (4, WRONG_TYPE), (5, WRONG_ORDER))
    ],
    *[  # early in the sweep the angle does not move far in 0.2 s
        (f"angle sensor, moving slowly, for 0.2 s: {fault}", bus(code, 40), 20, "", GOES_ON, None)
        for code, fault in ((2, "frozen"), (4, WRONG_TYPE), (5, WRONG_ORDER))
    ],
    *[
        (f"pressure sensor: {fault}", pressure(sensor, change), 5, name, REJECTED, 0)
        for fault, change in (
            ("over its limit", lambda volts: 3.0),  # 500 kPa
            ("cable off, 0 V", lambda volts: 0.0),
            ("spike of +100 kPa", lambda volts: volts + 0.4),
            ("no number", lambda volts: math.nan),
        )
        for sensor, name in enumerate(PRESSURES)
    ],
    *[
        ("pressure sensor: frozen", pressure(sensor, lambda volts: volts, math.inf), 26, name,
         FROZEN, 51)
        for sensor, name in enumerate(PRESSURES)
    ],
    ("the controller raises", controller(lambda: 1 / 0), 5, "ZeroDivisionError", FAILED, 0),
    ("the controller gives no number", controller(lambda: (math.nan, 0.0)), 5, "", FAILED, 0),
    ("the controller gives too few values", controller(tuple), 5, "", FAILED, 0),
    ("a stop is requested", asked_to_stop, 5, "stopped by SIGTERM", "the request", 0),
    ("an unexpected exception", unexpected, 5, "MemoryError", "the exception", 0),
]  # fmt: skip


@pytest.mark.parametrize(("fault", "make", "begin", "message", "ends", "until"), FAULTS)
def test_part_that_fails_in_mid_run_ends_it_vented(
    bench, record, matrix, fault, make, begin, message, ends, until
):
    ticks = 200 if until else 100
    found = record(ticks, **make(bench, begin))
    assert vented(bench)
    if until is None:
        assert (found.error, found.samples) == (None, ticks)
        assert len(np.unique(found.channels["theta_deg"][begin : begin + 40])) < 5
        matrix.add(fault, ends, "yes, at the end")
        return
    assert message in str(found.error)
    assert found.sessions[-1].tick == begin + until
    assert found.samples == begin + until
    matrix.add(fault, ends, ticks=until)


def test_disk_that_is_full_ends_the_run_vented(bench, record, matrix, monkeypatch, tmp_path):
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
    matrix.add("the disk is full", "the journal's error", ticks=0)


def test_interrupt_leaves_no_valve_open(bench, record):
    def interrupt(tick):
        if tick == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        record(at=interrupt)
    assert vented(bench)


@pytest.mark.parametrize("armed", [True, False])
def test_log_that_is_there_and_a_rig_that_is_not_armed_are_not_touched(
    bench, tmp_path, settings, caplog, armed
):
    caplog.set_level(logging.INFO, logger="fprc.rig")
    raw = tmp_path / "logs" / "sweep.h5"
    if armed:
        raw.parent.mkdir()
        raw.write_bytes(b"mine")
    refusal = OutputError if armed else ControlError
    with pytest.raises(refusal, match="exists" if armed else "not armed, nothing was moved"):
        record_on_rig(str(raw), name="sweep", settings=settings, armed=armed)
    assert bench.shared.calls == 0
    assert raw.parent.exists() is armed
    assert not armed or [path.read_bytes() for path in raw.parent.iterdir()] == [b"mine"]
    assert armed or "stops above 480 kPa" in caplog.text


def test_reason_of_a_run_is_kept_when_the_rig_cannot_be_closed_either(bench, record):
    found = record(**bus(1)(bench, 5))
    for text in (str(found.error), found.reason):
        assert "run stopped at sample 5: angle sensor 0x12 on I2C bus 1: reading the angle" in text
        assert "stopping it failed" in text


def test_loop_whose_guardian_has_ended_vents_until_the_board_answers(
    bench, settings, record, asking, monkeypatch
):
    settings["hardware"]["valves"]["vent_s"] = 0.4
    alone = partial(pneumatics.vent, sleep=bench.wait, now=bench.elapsed)
    monkeypatch.setattr(pneumatics, "vent", alone)
    monkeypatch.setattr(guardian, "_RETRY_S", 0.005)

    def fail(tick):
        if tick == 5:
            bench.fail(120)

    found = record(at=fail, stop=asking(guarded=False))
    assert bench.shared.failures == 120
    assert vented(bench)
    assert "both chambers are vented" in found.reason
    assert found.samples == 5
