"""Supervise the process that drives a real rig, and vent if it ends or stops responding.

A killed process cannot close a valve. The rig is therefore driven by a child process, the loop,
and this process, the guardian, watches it. Each sends heartbeats to the other, and vents when
those of the other stop.
"""

import json
import logging
import math
import os
import select
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from typing import IO, Any

from fprc.apparatus.contec import locked
from fprc.apparatus.hardware import POLL_S, NotVentedError, vent_from_outside
from fprc.errors import ControlError

log = logging.getLogger("fprc.rig")

#: Messages of the loop: it opens the boards, the rig may move, the loop is alive, the rig is safe
#: and released.
OPENING, ARMED, HEARTBEAT, SAFE = b"O", b"A", b".", b"S"
#: Time between two heartbeats of the guardian, s.
BEAT_S = 0.05
#: Times between two attempts to vent, and between two messages about them, s.
_RETRY_S, _MESSAGE_S = 0.1, 1.0
#: Number of stop signals after which the guardian kills the loop and vents.
_KILL_AFTER = 3
_GIVES_UP = "Ctrl-C, or where it is ignored `kill`, gives up"


def guard(request: Mapping[str, Any]) -> None:
    """Run a request in a child process and supervise it (see ``fprc.apparatus.process``).

    DeviceError: another process holds the boards, or this is not Linux; nothing was started.
    ControlError: the child failed, was killed or stopped responding; says whether the chambers are
    vented.
    """
    hardware = request["settings"]["hardware"]
    with locked(hardware) as locks:
        # the loop gets its own session: a closed terminal, Ctrl-Z or a kill of the process group
        # hits the guardian alone, and the loop then stops and vents
        process = _Process(
            [sys.executable, "-m", "fprc.apparatus.process"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,
            pass_fds=locks,
        )
        with _forwarding_signals(process) as received:
            with suppress(BrokenPipeError):  # it has already ended, with a message
                process.stdin.write(json.dumps(request).encode() + b"\n")
                process.stdin.flush()
            end = _watch(process, hardware["loop"])
            if end == "silent":
                process.kill()
            # vent before waiting for its end: until then the valves hold their voltages
            vented = "" if end == "safe" else vent_until_shown(hardware, received)
            code = _wait(process, received)
            if code is not None and end == "silent":
                # again: the last driver call of the killed process may have come after the venting
                vented = vent_until_shown(hardware, received)
    if code is None:
        problem = (
            f"({process.pid}) does not end: IT MAY STILL OPEN A VALVE. Cut the supply and open the "
            "chambers by hand, then restart the computer"
        )
    elif end == "safe":
        problem = f"failed (exit code {code}); see its messages above" if code else ""
    else:
        how = f"ended with code {code} before it released the rig"
        if end == "silent":
            how = "was silent for too long (hardware.loop), and was killed"
        problem = f"{how}; {vented}; `fprc log repair` reads the journal beside the log of its run"
    if problem:
        raise ControlError(f"the process that drives the rig {problem}")


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
    """Wait for the end of the process; return ``safe``, ``gone`` or ``silent``.

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
                return "silent"
            continue
        if not chunk:
            return "safe" if state == SAFE else "gone"
        silent = 0
        state = max(limits_s, key=(state + chunk).rfind)  # the latest


def _ends(received: Sequence[int]) -> int:
    """Count the signals that end a wait: Ctrl-C, or any where that is ignored (nohup, ``&``)."""
    ignored = signal.getsignal(signal.SIGINT) == signal.SIG_IGN
    return len(received) if ignored else received.count(signal.SIGINT)


def vent_until_shown(hardware: Mapping[str, Any], received: Sequence[int] | None = None) -> str:
    """Vent until the sensors confirm it or the user gives up; return the outcome as text.

    ``received`` has the signals to this process; one more gives up, see ``_ends``. Without it
    nobody can: a call of the driver that does not return in twice ``vent_s`` and a second does.
    """
    outcome, problem, given_up = list[str](), "the driver has not answered yet", threading.Event()
    longest_s = 2.0 * hardware["valves"]["vent_s"] + _MESSAGE_S if received is None else math.inf
    received = () if received is None else received  # a list that grows
    before, began_s = _ends(received), (printed_s := time.monotonic())

    def attempt() -> None:
        nonlocal began_s, problem
        while not given_up.is_set() and not outcome:
            began_s = time.monotonic()
            try:
                for known in vent_from_outside(hardware):
                    problem = known
                    time.sleep(POLL_S)
                outcome.append("both chambers are vented, as their sensors show")
            except NotVentedError as error:
                outcome.append(str(error))
            except Exception as error:  # of any type: the next attempt may succeed
                problem = f"{type(error).__name__}: {error}"
                given_up.wait(_RETRY_S)

    # in a thread that prints nothing: a call of the driver may never return, printing may block
    venting = threading.Thread(target=attempt, daemon=True)
    venting.start()
    while not outcome and _ends(received) <= before and time.monotonic() - began_s <= longest_s:
        venting.join(POLL_S)
        if time.monotonic() - printed_s > _MESSAGE_S:
            printed_s = time.monotonic()
            log.error("%s Still trying; %s", NotVentedError(problem), _GIVES_UP)
    given_up.set()
    return outcome[0] if outcome else str(NotVentedError(problem))


def _wait(process: _Process, received: Sequence[int]) -> int | None:
    """Wait for the end of a process and return its exit code; None if the user gave up."""
    before = _ends(received)
    while _ends(received) <= before:
        with suppress(subprocess.TimeoutExpired):
            code = process.wait(timeout=_MESSAGE_S)
            process.stdin.close()
            process.stdout.close()
            return code
        log.error("process %d has not ended; %s", process.pid, _GIVES_UP)
    return None


@contextmanager
def _forwarding_signals(process: _Process) -> Iterator[list[int]]:
    """Forward stop signals to the process, the third as a kill; yield the signals received."""
    received: list[int] = []

    def forward(number: int, frame: Any) -> None:
        received.append(number)
        process.send_signal(signal.SIGKILL if len(received) >= _KILL_AFTER else signal.SIGTERM)

    before = {}
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) != signal.SIG_IGN:  # as nohup does
            before[number] = signal.signal(number, forward)
    try:
        yield received
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
