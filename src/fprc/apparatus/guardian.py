"""Watch over the process that drives a real rig, and vent if it ends or falls silent.

A process that is killed cannot close a valve. What drives the rig therefore runs in a
process of its own, and this one waits for its signs of life and gives signs of its own:
each of the two vents when the other is silent.
"""

import json
import logging
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from io import BufferedReader
from typing import IO, Any

from fprc.devices.locks import describe, locked
from fprc.devices.pneumatics import NotVentedError, board_names, not_vented, vent_from_outside
from fprc.errors import ControlError

log = logging.getLogger("fprc.rig")

#: What the process says: the rig is hot, it is alive, the rig is safe and released.
HOT, ALIVE, SAFE = b"H", b".", b"S"
#: Time between two signs of life of this process, s.
BEAT_S = 0.05
#: Time between two attempts to vent, between two messages about them, and between two looks at
#: what came of them, s.
_RETRY_S, _SAY_S, _LOOK_S = 0.1, 1.0, 0.02
#: So many signals end a process that does not stop at the first; then this one vents.
_INSISTS = 3

_VENTED = "both chambers are vented, as their sensors show"
_NOT_VENTED = "THE CHAMBERS COULD NOT BE VENTED, cut the supply and open them by hand"


def guard(request: Mapping[str, Any], hardware: Mapping[str, Any]) -> None:
    """Have a request done by a process of its own (see ``fprc.apparatus.process``).

    Raises
    ------
    DeviceError
        Another process has the boards, or this is not Linux; nothing was started.
    ControlError
        The process failed, was killed or fell silent; says whether the chambers are vented.
    """
    boards = hardware["boards"]
    with locked(board_names(boards), boards["lock_folder"]) as locks:
        _guard(request, hardware, locks)


def _guard(request: Mapping[str, Any], hardware: Mapping[str, Any], locks: Sequence[int]) -> None:
    pipe = subprocess.PIPE
    # a session of its own: what befalls a terminal and its group (closed, Ctrl-Z, a kill of the
    # whole group) reaches this process alone, and the other one stops and vents
    process = _Process(
        [sys.executable, "-m", "fprc.apparatus.process"],
        stdin=pipe,
        stdout=pipe,
        start_new_session=True,
        pass_fds=locks,
    )
    describe(locks, f" (drives the rig by process {process.pid})")
    signs: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(process, signs), daemon=True).start()
    with _handing_on_signals(process) as heard:
        with suppress(BrokenPipeError):  # it ended at once, and says why
            process.stdin.write(json.dumps(request).encode() + b"\n")
            process.stdin.flush()
        end = _watch(signs, _beating(process), hardware["loop"]["stalled_s"])
        if end == "silent":
            process.kill()
        # at once: a killed process has left the valves as they were
        vented = "" if end == "safe" else _vent(hardware, heard)
        code = _wait(process, heard)
        if code is None:
            raise ControlError(
                f"process {process.pid}, which drives the rig, does not end: IT MAY STILL OPEN A "
                "VALVE. Cut the supply and open the chambers by hand, then restart the computer"
            )
        if end == "silent":
            # its last call to the driver may have ended after ours
            vented = _vent(hardware, heard)
    if end != "safe":
        how = "fell silent and was ended" if end == "silent" else f"ended with code {code}"
        kept = ". What it recorded is in the journal beside the log: fprc log repair"
        raise ControlError(
            f"the process that drives the rig {how} in the middle of a run; {vented}"
            + (kept if request["what"] == "run" else "")
        )
    if code:
        raise ControlError(f"the rig did not do what was asked (exit code {code}); see above")


class _Process(subprocess.Popen[bytes]):
    """A process that reads from and writes to pipes."""

    stdin: IO[bytes]
    stdout: BufferedReader


def _listen(process: _Process, signs: queue.SimpleQueue[bytes]) -> None:
    while chunk := process.stdout.read1(64):
        signs.put(chunk)
    signs.put(b"")


def _beating(process: _Process) -> Callable[[], None]:
    """Return what gives the process a sign of life, and never waits for it."""
    pipe = process.stdin.fileno()
    os.set_blocking(pipe, False)

    def beat() -> None:
        with suppress(BrokenPipeError, BlockingIOError):
            os.write(pipe, ALIVE)

    return beat


def _watch(signs: queue.SimpleQueue[bytes], beat: Callable[[], None], stalled_s: float) -> str:
    """Wait for the end of the process; return ``safe``, ``gone`` or ``silent``.

    Silence counts while the rig is hot: before and after that nothing moves. It is counted in
    waits of this process and not by a clock: after this process itself was stopped, it first
    hears what was said meanwhile.
    """
    hot, silent = False, 0
    while True:
        beat()
        try:
            chunk = signs.get(timeout=BEAT_S)
        except queue.Empty:
            silent += 1
            if hot and silent * BEAT_S >= stalled_s:
                return "silent"
            continue
        if not chunk:
            return "gone" if hot else "safe"
        said, silent = (HOT if hot else SAFE) + chunk, 0
        hot = said.rfind(HOT) > said.rfind(SAFE)


def _vent(hardware: Mapping[str, Any], heard: Sequence[int]) -> str:
    """Vent until the valves were told to, or a person gives up; say what came of it.

    A call of the driver may never return, and a terminal that is held takes no messages:
    attempts are made in a thread that says nothing, and this one says every second what stands.
    """
    before, began_s = heard.count(signal.SIGINT), time.monotonic()
    attempts = _Attempts(hardware)
    attempts.start()
    said_s, said = began_s, ""
    while True:
        with suppress(queue.Empty):
            return attempts.outcome.get(timeout=_LOOK_S)
        now_s, stands = time.monotonic(), attempts.stands
        since_s = attempts.written_s
        if since_s and now_s - since_s > 2.0 * hardware["valves"]["vent_s"] + _SAY_S:
            return str(not_vented("no pressure can be read: the driver does not answer"))
        if heard.count(signal.SIGINT) > before:
            attempts.given_up.set()
            if since_s:
                return str(not_vented("a person ended the waiting for the pressures"))
            return f"{_NOT_VENTED} ({stands})"
        if (stands and not said) or now_s - said_s > _SAY_S:
            said_s, said = now_s, stands
            log.error(
                "%s after %.1f s (%s). It is tried again and again; Ctrl-C gives up",
                "the valves were told to vent, and no reading shows yet that they did"
                if since_s
                else _NOT_VENTED,
                now_s - began_s,
                stands or "the driver has not answered yet",
            )


class _Attempts(threading.Thread):
    """Attempts to vent, one after the other."""

    def __init__(self, hardware: Mapping[str, Any]):
        super().__init__(daemon=True)
        self.outcome: queue.SimpleQueue[str] = queue.SimpleQueue()
        self.given_up = threading.Event()
        self.stands = ""  # why the valves could not be told
        self.written_s = 0.0  # when they were
        self._hardware = hardware

    def run(self) -> None:
        """Vent, and put what came of it into ``outcome``."""
        while not self.given_up.is_set():
            try:
                vent_from_outside(self._hardware, self._told)
            except NotVentedError as error:
                self.outcome.put(str(error))
            except Exception as error:  # whatever a driver raises: the next attempt may succeed
                self._told(f"{type(error).__name__}: {error}")
                self.given_up.wait(_RETRY_S)
                continue
            else:
                self.outcome.put(_VENTED)
            return

    def _told(self, why: str) -> None:
        if why:
            self.stands = why
        elif not self.written_s:
            self.written_s = time.monotonic()


def _wait(process: _Process, heard: Sequence[int]) -> int | None:
    """Wait for the end of a process and return its exit code; None if a person gave up."""
    before = heard.count(signal.SIGINT)
    while True:
        try:
            code = process.wait(timeout=_SAY_S)
        except subprocess.TimeoutExpired:
            if heard.count(signal.SIGINT) > before:
                return None
            log.error(
                "process %d has not ended: it may be in a call of the driver that does not "
                "return. Ctrl-C stops waiting for it",
                process.pid,
            )
        else:
            process.stdin.close()
            process.stdout.close()
            return code


@contextmanager
def _handing_on_signals(process: _Process) -> Iterator[list[int]]:
    """Have the process stop at a signal to this one; yield the signals so far."""
    received: list[int] = []

    def hand_on(number: int, frame: Any) -> None:
        received.append(number)
        process.send_signal(signal.SIGKILL if len(received) >= _INSISTS else signal.SIGTERM)

    names = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = {number: signal.getsignal(number) for number in names}
    heard = [number for number, handler in before.items() if handler != signal.SIG_IGN]  # nohup
    for number in heard:
        signal.signal(number, hand_on)
    try:
        yield received
    finally:
        for number in heard:
            signal.signal(number, before[number])
