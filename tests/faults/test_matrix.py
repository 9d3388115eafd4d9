"""Faults of parts, in this process: the rig runs on its bench's clock, tick by tick."""

import errno
import logging
import math
import signal
import time
from functools import partial
from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest

from fprc.apparatus import guardian, journal, pneumatics, process
from fprc.apparatus.guardian import ARMED, HEARTBEAT, OPENING, SAFE
from fprc.apparatus.record_on_rig import record_on_rig
from fprc.apparatus.recovery import read_journal
from fprc.apparatus.session import Stop
from fprc.errors import ControlError, FprcError, OutputError
from fprc.logs import read_columns

TICKS = 8
VENTED = [0.0, 0.0]
_WRITE = "AioSingleAoEx"
_OPEN = [
    *[(call, "opening the output board") for call in ("AioInit", "AioResetDevice")],
    ("AioSetAoRangeAll", "opening the output board"),
    *[(_WRITE, "venting on opening")] * 2,
    *[(call, "opening the input board") for call in ("AioInit", "AioResetDevice")],
    ("AioSetAiRangeAll", "opening the input board"),
]
_TICK = [("AioMultiAiEx", "reading pressures"), *[(_WRITE, "writing a valve")] * 2]
_SAFE = [(_WRITE, "venting at the end")] * 4
_LOOK = [
    *[(_WRITE, "venting until readings show it")] * 2,
    ("AioMultiAiEx", "reading whether the chambers are vented"),
]
_EXIT = [("AioExit", "releasing a board")] * 2
#: Every call of the driver in a run of eight ticks, by its part.
PARTS = {"open": _OPEN, "tick": _TICK * TICKS, "safe": _SAFE, "look": _LOOK * 10, "exit": _EXIT}
CALLS = [(part, *call) for part, calls in PARTS.items() for call in calls]


@pytest.fixture
def record(bench, settings, live_by, asking, monkeypatch, tmp_path):
    """Record a few ticks of the sweep; ``at(tick)`` injects; return error, journal, sessions."""
    settings["experiments"]["sweep"]["duration_s"] = 2.0
    plan = process.plan

    def record(ticks=TICKS, *, at=lambda tick: None, law=None, stop=None):
        found = SimpleNamespace()
        found.sessions, found.messages = live_by(bench, at)

        def cut(*arguments):
            experiment = plan(*arguments)
            return experiment._replace(samples=ticks, law=law or experiment.law)

        monkeypatch.setattr(process, "plan", cut)
        found.raw = tmp_path / "sweep.h5"
        found.error = None
        try:
            process.record("sweep", str(found.raw), settings=settings, stop=stop or asking())
        except FprcError as error:
            found.error = error
        (path,) = tmp_path.glob("*.journal")
        found.channels, _, findings = read_journal(path)
        found.samples, found.reason = findings.samples, findings.reason
        assert findings.closed
        assert findings.lost == 0
        return found

    return record


def vented(bench):
    return list(bench.shared.outputs[:2]) == VENTED


def test_run_without_a_fault_makes_the_calls_that_are_tried_below(bench, record):
    found = record()
    assert found.error is None
    assert bench.shared.calls == len(CALLS)
    assert found.samples == TICKS
    assert found.raw.exists()
    assert [message for message in found.messages if message != HEARTBEAT] == [OPENING, ARMED, SAFE]
    assert vented(bench)


def test_chamber_that_keeps_its_pressure_is_not_called_vented(bench, record, matrix, settings):
    settings["hardware"]["boards"]["main_output"] = 3  # the valve does not hear
    bench.shared.outputs[0] = 5.5
    found = record()
    assert "the samples are complete, but the rig was not closed: THE CHAMBERS MAY BE" in str(
        found.error
    )
    assert "are vented" not in str(found.error)
    assert SAFE not in found.messages
    matrix.add(
        "a valve stays open", "mid-run", "no reading shows that it vents",
        "no: the guardian tries, then says what to do by hand", "-", 0,
    )  # fmt: skip


def samples_before(at):
    """Return the samples that are complete when a call fails."""
    return min(max(at - len(_OPEN), 0) // len(_TICK), TICKS)


@pytest.mark.parametrize("at", range(len(CALLS)))
def test_call_of_the_driver_that_fails_once_ends_the_run_vented(bench, record, matrix, at):
    part, call, where = CALLS[at]
    shared = bench.shared
    bench.fail(skip=at)
    found = record()
    assert (shared.failures, shared.failed) == (1, call.encode())
    healed = part == "look"
    assert (f"{call} failed with code 777 (injected failure)" in str(found.error)) is not healed
    assert (f"{call} failed" in found.reason) is not healed
    assert vented(bench)
    last = found.sessions[-1]
    assert last.tick == last.clean_tick or healed
    # the sample of the tick in which the call failed was not complete
    assert found.samples == samples_before(at)
    assert found.raw.exists() is healed
    if part == "exit":
        assert "the samples are complete, but the rig was not closed: board AIO" in str(found.error)
        assert f"{TICKS} samples are in " in str(found.error)
    # without this message the guardian vents once more
    assert (found.messages[0], SAFE in found.messages) == (OPENING, part != "exit")
    assert (ARMED in found.messages) is (part != "open")
    assert shared.opened == (0 if call != "AioExit" else 1)
    ends = {"open": "the run does not start", "look": "nothing: it is retried"}
    matrix.add(
        "a driver call fails once",
        where,
        ends.get(part, "the driver's error"),
        "yes",
        "-" if healed else last.tick - last.clean_tick,
        samples_before(at) - found.samples,
    )


@pytest.mark.parametrize("at", range(len(CALLS)))
def test_board_that_fails_for_good_ends_the_run_without_the_message_safe(bench, record, matrix, at):
    part, call, where = CALLS[at]
    shared = bench.shared
    bench.fail(1 << 40, skip=at)
    found = record()
    assert shared.failures == shared.calls - at
    assert f"{call} failed with code 777" in str(found.error)
    last = found.sessions[-1]
    assert last.tick == last.clean_tick
    assert found.samples == samples_before(at)
    # before a run there is nothing to be made safe
    assert (SAFE in found.messages) is (part == "open")
    # nothing had moved before the first tick's writes, or it was vented already
    begun = len(_OPEN) + 1
    moved = begun < at < len(_OPEN) + len(_TICK) * TICKS + len(_SAFE)
    assert vented(bench) is not moved
    if part in ("tick", "safe"):
        assert "the rig could not be made safe" in str(found.error)
    matrix.add(
        "every driver call fails from then on",
        where,
        "the run does not start" if part == "open" else "the driver's error",
        "yes" if not moved else "no: the guardian tries until it succeeds",
        "-" if moved else last.tick - last.clean_tick,
        samples_before(at) - found.samples,
    )


@pytest.mark.parametrize("failures", [6, 12, 40])
def test_board_that_fails_for_a_moment_is_vented_as_soon_as_it_answers(
    bench, record, matrix, failures
):
    shared = bench.shared
    bench.fail(failures, skip=len(_OPEN) + 4 * len(_TICK))
    found = record()
    assert shared.failures == failures
    assert vented(bench)
    assert SAFE in found.messages
    # written again before every reading, not only once the time to vent is over
    lost = bench.tick - found.sessions[-1].tick
    assert lost * bench.period_s < 0.02 * (failures + 15)
    matrix.add("the board fails for a moment", "mid-run", "the driver's error",
               "yes, once it answers", "-", 0)  # fmt: skip


def bus(code, ticks=math.inf):
    """Return what sets a fault of the I2C bus for some ticks, from one on."""

    def make(bench, settings, begin):
        def at(tick):
            bench.shared.i2c_fault = code if begin <= tick < begin + ticks else 0

        return {"at": at}

    return make


def pressure(sensor, change):
    """Return what changes the voltage of a pressure sensor at a tick."""

    def make(bench, settings, begin):
        own = settings["hardware"]["p_exp"]

        def volts_at(kpa):
            return own["zero_v"] + kpa / own["gain_kpa_per_v"]

        def at(tick):
            if tick == begin:
                bench.shared.inputs[sensor] = change(bench.shared.inputs[sensor], volts_at)

        return {"at": at}

    return make


def frozen(sensor):
    def make(bench, settings, begin):
        held = []

        def at(tick):
            if tick >= begin:
                held.append(bench.shared.inputs[sensor])
                bench.shared.inputs[sensor] = held[0]

        return {"at": at}

    return make


def controller(respond):
    def make(bench, settings, begin):
        return {"law": lambda k, now: respond() if k == begin else (10.0, 0.0)}

    return make


def asked_to_stop(bench, settings, begin):
    asked = []
    stop = Mock(side_effect=lambda: "stopped by SIGTERM" if asked[-1] == begin else "")
    return {"at": asked.append, "stop": stop}


PRESSURES = ("p_exp_kpa", "p_i_kpa", "p_o_kpa")
REJECTED, FROZEN, GOES_ON = "a rejected reading", "frozen sensor", "nothing: the run continues"
FAILED = "the controller's error"
#: What fails, how, at which tick, the message, what ends the run, and how many ticks later.
FAULTS = [
    ("angle sensor: dropout, one packet", bus(1, 1), 20, "angle", REJECTED, 0),
    ("angle sensor: spike of +90 deg, one packet", bus(3, 1), 20, "theta_deg", REJECTED, 0),
    ("angle sensor: packet cut short, once", bus(6, 1), 20, "2 bytes, not 3", REJECTED, 0),
    ("angle sensor: frozen", bus(2), 20, "theta_deg", FROZEN, 50),
    ("angle sensor: packets of the wrong type", bus(4), 20, "theta_deg", FROZEN, 50),
    ("angle sensor: packets with their bytes in the wrong order", bus(5), 20, "theta_deg", FROZEN,
     50),
    # early in the sweep the angle does not move far in 0.2 s
    ("angle sensor, moving slowly: frozen for 0.2 s", bus(2, 40), 20, "", GOES_ON, None),
    ("angle sensor, moving slowly: packets of the wrong type for 0.2 s", bus(4, 40), 20, "",
     GOES_ON, None),
    ("angle sensor, moving slowly: packets with their bytes in the wrong order for 0.2 s",
     bus(5, 40), 20, "", GOES_ON, None),
    *[
        (f"pressure sensor: {fault}", pressure(sensor, change), 5, name, REJECTED, 0)
        for fault, change in (
            ("over its limit", lambda volts, volts_at: volts_at(500.0)),
            ("cable off, 0 V", lambda volts, volts_at: 0.0),
            ("spike of +100 kPa", lambda volts, volts_at: volts + volts_at(100.0) - volts_at(0.0)),
            ("no number", lambda volts, volts_at: math.nan),
        )
        for sensor, name in enumerate(PRESSURES)
    ],
    *[
        ("pressure sensor: frozen", frozen(sensor), 26, name, FROZEN, 51)
        for sensor, name in enumerate(PRESSURES)
    ],
    ("the controller raises", controller(lambda: 1 / 0), 5, "ZeroDivisionError", FAILED, 0),
    ("the controller gives no number", controller(lambda: (math.nan, 0.0)), 5, "", FAILED, 0),
    ("the controller gives too few values", controller(tuple), 5, "", FAILED, 0),
    ("a stop is requested", asked_to_stop, 5, "stopped by SIGTERM", "the request", 0),
]  # fmt: skip


@pytest.mark.parametrize(("fault", "make", "begin", "message", "ends", "until"), FAULTS)
def test_part_that_fails_in_mid_run_ends_it_vented(
    bench, settings, record, matrix, fault, make, begin, message, ends, until
):
    ticks = 200 if until else 100
    found = record(ticks, **make(bench, settings, begin))
    assert vented(bench)
    if until is None:
        assert (found.error, found.samples) == (None, ticks)
        held = found.channels["theta_deg"][begin : begin + 40]
        assert len(np.unique(held)) < 5
        matrix.add(fault, "mid-run", ends, "yes, at the end", "-", 0)
        return
    assert message in str(found.error)
    after = found.sessions[-1].tick - begin
    assert after == until
    assert found.samples == begin + until
    matrix.add(fault, "mid-run", ends, "yes", after, begin + after - found.samples)


def test_computer_that_was_suspended_ends_the_run_vented(bench, record, matrix, monkeypatch):
    suspended_s = [0.0]
    monkeypatch.setattr(Stop, "_listen", lambda self: None)
    monkeypatch.setattr(signal, "signal", lambda number, handler: None)
    monkeypatch.setattr(time, "clock_gettime", lambda which: time.monotonic() + suspended_s[0])
    stop = Stop(1e6)

    def at(tick):
        if tick == 5:
            suspended_s[0] = 3.0

    found = record(at=at, stop=stop)
    assert "the computer was suspended for 3.0 s" in str(found.error)
    assert vented(bench)
    assert found.samples == 5
    matrix.add("the computer is suspended", "mid-run", "the loop, once the computer resumes", "yes",
               found.sessions[-1].tick - 5, 0)  # fmt: skip


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
    assert found.samples == 5
    (rescued,) = tmp_path.glob("*.rescued.h5")
    saved = len(read_columns(rescued, ("time_s",)).channels["time_s"])
    after = found.sessions[-1].tick - 5
    matrix.add("the disk is full", "mid-run", "the journal's error", "yes", after, 6 - saved)


def test_unexpected_exception_leaves_no_valve_open(bench, record, matrix):
    def interrupt(tick):
        if tick == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        record(at=interrupt)
    assert vented(bench)
    matrix.add("an unexpected exception", "mid-run", "the exception", "yes", 0, 0)


def test_log_that_is_there_is_not_recorded_again(bench, tmp_path, settings):
    raw = tmp_path / "sweep.h5"
    raw.write_bytes(b"mine")
    with pytest.raises(OutputError, match="exists and is not overwritten"):
        record_on_rig(str(raw), name="sweep", settings=settings, armed=True)
    assert raw.read_bytes() == b"mine"
    assert bench.shared.calls == 0
    assert not list(tmp_path.glob("*.journal"))


def test_rig_that_is_not_armed_is_not_touched(bench, settings, tmp_path, caplog):
    caplog.set_level(logging.INFO, logger="fprc.rig")
    raw = tmp_path / "logs" / "sweep.h5"
    with pytest.raises(ControlError, match="sweep: not armed, nothing was moved; .* --armed"):
        record_on_rig(str(raw), name="sweep", settings=settings, armed=False)
    assert f"sweep: 120 s on the real rig, into {raw}; stops above 480 kPa" in caplog.text
    assert bench.shared.calls == 0
    assert not raw.parent.exists()


def test_reason_of_a_run_is_kept_when_the_rig_cannot_be_closed_either(bench, record):
    found = record(**bus(1)(bench, None, 5))
    for text in (str(found.error), found.reason):
        assert "run stopped at sample 5: angle sensor 0x12 on I2C bus 1: reading the angle" in text
        assert "stopping it failed" in text


def test_loop_whose_guardian_has_ended_vents_until_the_board_answers(
    bench, settings, record, asking, monkeypatch
):
    shared = bench.shared
    settings["hardware"]["valves"]["vent_s"] = 0.4
    alone = partial(pneumatics.vent, sleep=bench.wait, now=bench.elapsed)
    monkeypatch.setattr(pneumatics, "vent", alone)
    monkeypatch.setattr(guardian, "_RETRY_S", 0.005)

    def fail(tick):
        if tick == 5:
            bench.fail(120)

    found = record(at=fail, stop=asking(guarded=False))
    assert shared.failures == 120
    assert vented(bench)
    assert "both chambers are vented" in found.reason
    assert found.samples == 5
