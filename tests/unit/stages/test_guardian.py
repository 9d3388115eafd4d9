import io
import logging
import queue
import signal
import threading
import time
from types import SimpleNamespace

import pytest

from fprc.stages import guardian
from fprc.stages.guardian import BEAT_S, _listen, _vent, _wait, _watch


def signs(*chunks):
    told = queue.SimpleQueue()
    for chunk in chunks:
        told.put(chunk)
    return told


@pytest.fixture
def heard():
    """Signals of a person to the guardian."""
    return []


@pytest.fixture
def quick(monkeypatch):
    monkeypatch.setattr(guardian, "_SAY_S", 0.02)
    monkeypatch.setattr(guardian, "_RETRY_S", 0.005)


@pytest.mark.parametrize(
    ("chunks", "end"),
    [
        ([b""], "safe"),  # it ended before anything could move
        ([b"H", b""], "gone"),
        ([b"H..", b".", b""], "gone"),
        ([b"H...", b".S", b""], "safe"),
        ([b"H.SH..S", b""], "safe"),  # a check: two sessions
        ([b"H.SH", b""], "gone"),
        ([b"H.S", b"H.", b""], "gone"),
        ([b"H"], "silent"),
        ([b"H.SH", b"..."], "silent"),
    ],
)
def test_end_of_the_loop_is_told_from_its_signs(chunks, end):
    assert _watch(signs(*chunks), lambda: None, 0.01) == end


class Waits(queue.SimpleQueue):
    """Signs of a loop; each None is a wait in vain."""

    def __init__(self, *chunks):
        self.left = list(chunks)

    def get(self, timeout):
        if (chunk := self.left.pop(0)) is None:
            raise queue.Empty
        return chunk


def test_silence_of_a_rig_that_is_safe_is_waited_out_with_signs_of_life_of_the_guardian():
    beats = []
    told = Waits(*[None] * 30, b"H", b".S", *[None] * 30, b"")
    assert _watch(told, lambda: beats.append(1), 0.5) == "safe"
    assert len(beats) == 63


def test_silence_is_counted_in_waits_so_that_a_guardian_that_was_stopped_hears_first():
    stalled = round(0.5 / BEAT_S)
    nearly = [None] * (stalled - 1)
    assert _watch(Waits(b"H", *nearly, b".", *nearly, b"S", b""), lambda: None, 0.5) == "safe"
    assert _watch(Waits(b"H", *nearly, b".", *nearly, None), lambda: None, 0.5) == "silent"


def test_end_of_the_output_is_passed_on():
    told = queue.SimpleQueue()
    _listen(SimpleNamespace(stdout=io.BytesIO(b"H.S")), told)
    assert [told.get(), told.get()] == [b"H.S", b""]


def test_chambers_are_vented_over_a_connection_of_its_own(bench, settings, heard):
    bench.shared.outputs[:2] = [9.0, 9.0]
    assert _vent(settings["hardware"], heard) == "both chambers are vented, as their sensors show"
    assert list(bench.shared.outputs[:2]) == [0.0, 0.0]
    assert bench.shared.opened == 0


def test_chambers_that_read_pressure_are_not_called_vented(bench, settings, heard):
    settings["hardware"]["valves"]["vent_s"] = 0.1
    bench.shared.inputs[0] = 1.6
    said = _vent(settings["hardware"], heard)
    assert said.startswith("THE CHAMBERS MAY BE UNDER PRESSURE")
    assert "p_exp_kpa = 150.0 and p_i_kpa = " in said
    assert list(bench.shared.outputs[:2]) == [0.0, 0.0]


def test_chambers_that_no_sensor_shows_are_not_called_vented(bench, settings, heard):
    settings["hardware"]["boards"]["input_device"] = "AIO007"
    said = _vent(settings["hardware"], heard)
    assert "no pressure can be read (board AIO007: AioInit failed with code 10000" in said
    assert list(bench.shared.outputs[:2]) == [0.0, 0.0]
    assert bench.shared.opened == 0


@pytest.mark.parametrize("failures", [1, 6, 40])
def test_board_that_fails_and_recovers_is_tried_until_it_vents(
    bench, settings, heard, quick, caplog, failures
):
    shared = bench.shared
    shared.outputs[:2] = [9.0, 9.0]
    shared.fail_at, shared.fail_count, shared.fail_code = 1, failures, 777
    assert _vent(settings["hardware"], heard) == "both chambers are vented, as their sensors show"
    assert shared.failures == failures
    assert list(shared.outputs[:2]) == [0.0, 0.0]
    # a person is told at the first failure
    assert caplog.records[0].levelno == logging.ERROR
    assert caplog.messages[0].startswith("THE CHAMBERS COULD NOT BE VENTED, cut the supply")
    assert "board AIO001: AioInit failed with code 777" in caplog.messages[0]


def test_venting_is_given_up_only_by_a_person(bench, settings, heard, quick, caplog):
    shared = bench.shared
    shared.outputs[:2] = [9.0, 9.0]
    shared.fail_at, shared.fail_count, shared.fail_code = 1, 1 << 40, 777

    def give_up():
        while len(caplog.messages) < 5:
            time.sleep(0.01)
        heard.append(signal.SIGINT)

    person = threading.Thread(target=give_up)
    person.start()
    said = _vent(settings["hardware"], heard)
    person.join()
    assert said.startswith("THE CHAMBERS COULD NOT BE VENTED")
    assert "failed with code 777" in said
    assert shared.failures > 5
    assert all("failed with code 777" in message for message in caplog.messages)


def test_driver_that_never_answers_is_told_while_it_is_waited_for(
    settings, heard, quick, caplog, monkeypatch
):
    answer = threading.Event()
    monkeypatch.setattr(guardian, "vent", lambda hardware, written: answer.wait(10.0))

    def recover():
        while len(caplog.messages) < 2:
            time.sleep(0.01)
        answer.set()

    person = threading.Thread(target=recover)
    person.start()
    assert _vent(settings["hardware"], heard) == "both chambers are vented, as their sensors show"
    person.join()
    assert "the driver has not answered yet" in caplog.messages[0]


def test_driver_that_does_not_answer_a_reading_is_not_waited_for_without_end(
    settings, heard, quick, monkeypatch
):
    never = threading.Event()

    def vent(hardware, written):
        written()
        never.wait(10.0)

    monkeypatch.setattr(guardian, "vent", vent)
    settings["hardware"]["valves"]["vent_s"] = 0.1
    said = _vent(settings["hardware"], heard)
    never.set()
    assert "both valves were told to vent, but no pressure can be read: the driver" in said


def test_guardian_asks_for_no_reset_of_what_the_board_puts_out(bench, settings, heard):
    resets = []
    driver = guardian.vent.__globals__["AnalogOutput"]

    def spy(*arguments, reset):
        resets.append(reset)
        return driver(*arguments, reset=reset)

    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(guardian.vent.__globals__, "AnalogOutput", spy)
        _vent(settings["hardware"], heard)
    assert resets == [False]


def test_process_that_does_not_end_is_told_and_waited_for_until_a_person_gives_up(quick, caplog):
    class Process:
        pid = 4711

        def wait(self, timeout):
            waits.append(timeout)
            if len(waits) == 4:
                heard.append(signal.SIGINT)
            raise guardian.subprocess.TimeoutExpired("rig", timeout)

    waits, heard = [], []
    assert _wait(Process(), heard) is None
    assert len(waits) == 4
    assert all("process 4711 has not ended" in message for message in caplog.messages)
