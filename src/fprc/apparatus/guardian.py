"""Supervise the process that drives a real rig, and vent if it ends or stops responding.

A killed process cannot close a valve. The rig is therefore driven by a child process, the loop,
and this process, the guardian, watches it. Each sends heartbeats to the other, and vents when
those of the other stop.
"""

import json
import logging
import math
import os
import queue
import select
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from typing import IO, Any

from fprc.apparatus.locks import locked
from fprc.apparatus.pneumatics import NotVentedError, board_names, vent_from_outside
from fprc.errors import ControlError

log = logging.getLogger("fprc.rig")

#: Messages of the loop: it opens the boards, the rig may move, the loop is alive, the rig is safe
#: and released.
OPENING, ARMED, HEARTBEAT, SAFE = b"O", b"A", b".", b"S"
#: Time between two heartbeats of the guardian, s.
BEAT_S = 0.05
#: Times between two attempts to vent, between two messages about them, and between two checks of
#: their outcome, s.
_RETRY_S, _MESSAGE_S, _POLL_S = 0.1, 1.0, 0.02
#: Ends of the watch at which the guardian kills the loop.
_KILLED = ("silent", "stuck")
#: Number of stop signals after which the guardian kills the loop and vents.
_KILL_AFTER = 3

_VENTED = "both chambers are vented, as their sensors show"
_NOT_VENTED = "THE CHAMBERS COULD NOT BE VENTED, cut the supply and open them by hand"


def guard(request: Mapping[str, Any]) -> None:
    """Run a request in a child process and supervise it (see ``fprc.apparatus.process``).

    Raises
    ------
    DeviceError
        Another process holds the boards, or this is not Linux; nothing was started.
    ControlError
        The child failed, was killed or stopped responding; says whether the chambers are vented.
    """
    hardware = request["settings"]["hardware"]
    boards = hardware["boards"]
    with locked(board_names(boards)) as locks:
        _guard(request, hardware, locks)


def _guard(request: Mapping[str, Any], hardware: Mapping[str, Any], locks: Sequence[int]) -> None:
    pipe = subprocess.PIPE
    # the loop gets its own session: a closed terminal, Ctrl-Z or a kill of the process group
    # hits the guardian alone, and the loop then stops and vents
    process = _Process(
        [sys.executable, "-m", "fprc.apparatus.process"],
        stdin=pipe,
        stdout=pipe,
        start_new_session=True,
        pass_fds=locks,
    )
    with _forwarding_signals(process) as received:
        with suppress(BrokenPipeError):  # it has already ended, with a message
            process.stdin.write(json.dumps(request).encode() + b"\n")
            process.stdin.flush()
        end = _watch(process, hardware["loop"])
        if end in _KILLED:
            process.kill()
        # vent before waiting for the end of the process: until then the valves hold their voltages
        vented = "" if end == "safe" else vent_until_shown(hardware, received)
        code = _wait(process, received)
        if code is None:
            raise ControlError(
                f"process {process.pid}, which drives the rig, does not end: IT MAY STILL OPEN A "
                "VALVE. Cut the supply and open the chambers by hand, then restart the computer"
            )
        if end in _KILLED:
            # again: the last driver call of the killed process may have come after the venting
            vented = vent_until_shown(hardware, received)
    drives = "the process that drives the rig"
    kept = "; if a run had begun, its samples are in the journal beside its log: fprc log repair"
    if end != "safe":
        opening_s = hardware["loop"]["opening_s"]
        how = {
            "gone": f"ended with code {code} before it released the rig",
            "silent": "stopped responding before it released the rig, and was killed",
            "stuck": f"had not opened the boards after {opening_s:g} s (hardware.loop.opening_s) "
            "and was killed",
        }
        raise ControlError(f"{drives} {how[end]}; {vented}{kept}")
    if code < 0:
        raise ControlError(
            f"{drives} was ended by {signal.Signals(-code).name}, before it opened the boards or "
            f"after it vented{kept}"
        )
    if code:
        raise ControlError(f"{drives} failed (exit code {code}); see its messages above")


class _Process(subprocess.Popen[bytes]):
    """A process with pipes on its standard input and output."""

    stdin: IO[bytes]
    stdout: IO[bytes]

    def beat(self) -> None:
        """Send a heartbeat to the process, without blocking."""
        os.set_blocking(self.stdin.fileno(), False)
        with suppress(BrokenPipeError, BlockingIOError):
            os.write(self.stdin.fileno(), HEARTBEAT)

    def listen(self) -> bytes | None:
        """Return messages of the process, empty if it closed the pipe; None after ``BEAT_S``."""
        heard, _, _ = select.select([self.stdout], [], [], BEAT_S)
        return os.read(self.stdout.fileno(), 64) if heard else None


def _watch(process: _Process, loop: Mapping[str, float]) -> str:
    """Wait for the end of the process; return ``safe``, ``gone``, ``silent`` or ``stuck``.

    Silence is limited to ``opening_s`` after ``OPENING``, since a driver may take seconds to open a
    board, and to ``stalled_s`` after ``ARMED``. It is counted in timeouts, not by a clock: a
    guardian that was suspended itself therefore first reads the messages that arrived meanwhile.
    """
    limits_s = {OPENING: loop["opening_s"], ARMED: loop["stalled_s"], SAFE: math.inf}
    state, silent = SAFE, 0
    while True:
        process.beat()
        chunk = process.listen()
        if chunk is None:
            silent += 1
            if silent * BEAT_S >= limits_s[state]:
                return "stuck" if state == OPENING else "silent"
            continue
        if not chunk:
            return "safe" if state == SAFE else "gone"
        silent = 0
        state = max(limits_s, key=(state + chunk).rfind)  # the latest


def vent_until_shown(hardware: Mapping[str, Any], received: Sequence[int] = ()) -> str:
    """Vent until the sensors confirm it or the user gives up; return the outcome as text.

    A driver call may never return, and printing may block. Another thread therefore makes the
    attempts and prints nothing; this one prints the state every second.
    """
    before, began_s = received.count(signal.SIGINT), time.monotonic()
    given_up, reports = threading.Event(), queue.SimpleQueue[tuple[str, str]]()
    threading.Thread(target=_attempt, args=(hardware, given_up, reports), daemon=True).start()
    printed_s, printed, problem, written_s = began_s, "", "", 0.0
    while True:
        with suppress(queue.Empty):
            what, text = reports.get(timeout=_POLL_S)
            if what == "outcome":
                return text
            if text:
                problem = text
            else:
                written_s = written_s or time.monotonic()
        now_s = time.monotonic()
        answer = f"the driver {'took the voltages' if written_s else 'has not answered yet'}"
        if written_s and now_s - written_s > 2.0 * hardware["valves"]["vent_s"] + _MESSAGE_S:
            return str(NotVentedError("no pressure can be read: the driver does not answer"))
        if received.count(signal.SIGINT) > before:
            given_up.set()
            if written_s:
                return str(NotVentedError("Ctrl-C ended the wait for the pressures"))
            return f"{_NOT_VENTED} ({problem or answer})"
        if (problem and not printed) or now_s - printed_s > _MESSAGE_S:
            printed_s, printed = now_s, problem
            log.error(
                "%s after %.1f s (%s). Still trying; Ctrl-C gives up",
                "the valves were set to vent, but no reading confirms it yet"
                if written_s
                else _NOT_VENTED,
                now_s - began_s,
                problem or answer,
            )


def _attempt(
    hardware: Mapping[str, Any],
    given_up: threading.Event,
    reports: queue.SimpleQueue[tuple[str, str]],
) -> None:
    """Try to vent until it succeeds or is given up; report each write and the outcome.

    A write is reported by its error, which is empty if it succeeded.
    """
    while not given_up.is_set():
        try:
            vent_from_outside(hardware, lambda error: reports.put(("write", error)))
            return reports.put(("outcome", _VENTED))
        except NotVentedError as error:
            return reports.put(("outcome", str(error)))
        except Exception as error:  # of any type: the next attempt may succeed
            reports.put(("write", f"{type(error).__name__}: {error}"))
            given_up.wait(_RETRY_S)


def _wait(process: _Process, received: Sequence[int]) -> int | None:
    """Wait for the end of a process and return its exit code; None if the user gave up."""
    before = received.count(signal.SIGINT)
    while True:
        with suppress(subprocess.TimeoutExpired):
            code = process.wait(timeout=_MESSAGE_S)
            process.stdin.close()
            process.stdout.close()
            return code
        if received.count(signal.SIGINT) > before:
            return None
        log.error(
            "process %d has not ended: it may hang in a driver call. Ctrl-C stops the wait",
            process.pid,
        )


@contextmanager
def _forwarding_signals(process: _Process) -> Iterator[list[int]]:
    """Forward stop signals to the process, the third as a kill; yield the signals received."""
    received: list[int] = []

    def forward(number: int, frame: Any) -> None:
        received.append(number)
        process.send_signal(signal.SIGKILL if len(received) >= _KILL_AFTER else signal.SIGTERM)

    names = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = {number: signal.getsignal(number) for number in names}
    handled = [number for number, handler in before.items() if handler != signal.SIG_IGN]  # nohup
    for number in handled:
        signal.signal(number, forward)
    try:
        yield received
    finally:
        for number in handled:
            signal.signal(number, before[number])
