"""Watch over the process that drives a real rig, and vent if it ends or falls silent.

A process that is killed cannot close a valve. What drives the rig therefore runs
in a process of its own, and this one does nothing but wait for its signs of life.
"""

import json
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping
from contextlib import contextmanager, suppress
from typing import Any

from fprc.devices.hardware import open_valves
from fprc.errors import ControlError, DeviceError

#: What the process says: the rig is hot, it is alive, the rig is safe and released.
HOT, ALIVE, SAFE = b"H", b".", b"S"


def guard(request: Mapping[str, Any], hardware: Mapping[str, Any]) -> None:
    """Have a request done by a process of its own (see ``fprc.stages.rig_loop``).

    Raises
    ------
    ControlError
        The process failed, was killed or fell silent. The chambers were vented,
        or the message says that they could not be.
    """
    command = [sys.executable, "-m", "fprc.stages.rig_loop"]
    pipe = subprocess.PIPE
    # a session of its own: what befalls a terminal and its group (closed, Ctrl-Z, a kill of the
    # whole group) reaches this process alone, and the other one stops and vents
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, start_new_session=True) as process:
        signs: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        threading.Thread(target=_listen, args=(process, signs), daemon=True).start()
        with _handing_on_signals(process):
            with suppress(BrokenPipeError):  # it ended at once, and says why
                process.stdin.write(json.dumps(request).encode() + b"\n")
                process.stdin.flush()
            end = _watch(signs, hardware["loop"]["stalled_s"])
            if end == "silent":
                process.kill()
            # at once: a killed process has left the valves as they were
            vented = "" if end == "safe" else _vent(hardware)
            code = process.wait()
            if end == "silent":
                # its last call to the driver may have ended after ours
                vented = _vent(hardware)
    if end != "safe":
        how = "fell silent and was ended" if end == "silent" else f"ended with code {code}"
        raise ControlError(
            f"the process that drives the rig {how} in the middle of a run; {vented}. What it "
            "recorded is in the journal beside the log: fprc log repair"
        )
    if code:
        raise ControlError("the rig did not do what was asked; see above")


def _listen(process: subprocess.Popen, signs: queue.SimpleQueue) -> None:
    while chunk := process.stdout.read1(64):
        signs.put(chunk)
    signs.put(b"")


def _watch(signs: queue.SimpleQueue, stalled_s: float) -> str:
    """Wait for the end of the process; return ``safe``, ``gone`` or ``silent``.

    The clock of silence runs while the rig is hot: before and after that nothing moves.
    """
    hot = False
    while True:
        try:
            chunk = signs.get(timeout=stalled_s if hot else None)
        except queue.Empty:
            return "silent"
        if not chunk:
            return "gone" if hot else "safe"
        said = (HOT if hot else SAFE) + chunk
        hot = said.rfind(HOT) > said.rfind(SAFE)


def _vent(hardware: Mapping[str, Any]) -> str:
    """Vent over a connection of our own; say what came of it."""
    try:
        open_valves(hardware, reset=False).close()
    except DeviceError as error:
        return f"THE CHAMBERS COULD NOT BE VENTED, cut the supply by hand ({error})"
    return "both chambers were vented"


@contextmanager
def _handing_on_signals(process: subprocess.Popen):
    def hand_on(number: int, frame: Any) -> None:
        process.send_signal(signal.SIGTERM)

    names = ("SIGINT", "SIGTERM", "SIGHUP")
    before = {number: signal.getsignal(number) for name in names if (number := _number(name))}
    heard = [number for number, handler in before.items() if handler != signal.SIG_IGN]  # nohup
    for number in heard:
        signal.signal(number, hand_on)
    try:
        yield
    finally:
        for number in heard:
            signal.signal(number, before[number])


def _number(name: str) -> int | None:
    return getattr(signal, name, None)  # Windows has no SIGHUP
