import io
import queue
from types import SimpleNamespace

import pytest

from fprc.stages import guardian
from fprc.stages.guardian import _listen, _vent, _watch


def signs(*chunks):
    told = queue.SimpleQueue()
    for chunk in chunks:
        told.put(chunk)
    return told


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
    assert _watch(signs(*chunks), 0.01) == end


def test_silence_of_a_rig_that_is_safe_is_waited_out():
    class Signs(queue.SimpleQueue):
        def get(self, timeout):
            waited.append(timeout)
            return super().get()

    waited, told = [], Signs()
    for chunk in (b"H", b".S", b""):
        told.put(chunk)
    assert _watch(told, 0.5) == "safe"
    assert waited == [None, 0.5, None]


def test_end_of_the_output_is_passed_on():
    told = queue.SimpleQueue()
    _listen(SimpleNamespace(stdout=io.BytesIO(b"H.S")), told)
    assert [told.get(), told.get()] == [b"H.S", b""]


def test_chambers_are_vented_over_a_connection_of_its_own(bench, settings):
    bench.shared.outputs[:2] = [9.0, 9.0]
    assert _vent(settings["hardware"]) == "both chambers were vented"
    assert list(bench.shared.outputs[:2]) == [0.0, 0.0]
    assert bench.shared.opened == 0


def test_chambers_that_cannot_be_vented_are_told_to_a_person(bench, settings):
    shared = bench.shared
    shared.outputs[:2] = [9.0, 9.0]
    shared.fail_at, shared.fail_count, shared.fail_code = 1, 1 << 40, 777
    said = _vent(settings["hardware"])
    assert said.startswith("THE CHAMBERS COULD NOT BE VENTED, cut the supply by hand (board AIO001")
    assert shared.failures > 0


def test_guardian_asks_for_no_reset_of_what_the_board_puts_out(monkeypatch, settings):
    asked = []

    def open_valves(hardware, *, reset):
        asked.append(reset)
        return SimpleNamespace(close=lambda: None)

    monkeypatch.setattr(guardian, "open_valves", open_valves)
    _vent(settings["hardware"])
    assert asked == [False]
