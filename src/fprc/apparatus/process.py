"""The process that drives a real rig; started and supervised by ``fprc.apparatus.guardian``.

From standard input it reads a request, one line of JSON, and then the guardian's heartbeats; it
stops when these cease or the input is closed. To standard output it writes ``OPENING`` before it
opens the boards, ``ARMED`` before anything can move, then heartbeats, and ``SAFE`` once the rig is
released and readings show it vented.
"""

import gc
import json
import logging
import os
import sys
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from fprc.apparatus.check import check_rig
from fprc.apparatus.command import plan
from fprc.apparatus.journal import Journal, state_of
from fprc.apparatus.session import Guardian, on_rig
from fprc.artifacts import refuse_output
from fprc.channels import RAW_CHANNELS
from fprc.errors import ControlError, FprcError, LogError
from fprc.logs import write_raw

log = logging.getLogger("fprc.rig")


def main() -> int:
    """Carry out the request; return the exit code."""
    logging.basicConfig(level=logging.INFO, format="[rig] %(message)s")
    # unbuffered, because the bytes after the line are heartbeats
    with open(0, "rb", buffering=0, closefd=False) as unbuffered:
        request = json.loads(unbuffered.readline())
    messages = os.dup(1)
    os.dup2(2, 1)  # what a driver prints must not pass for a message
    gc.disable()  # a collection may take longer than a tick
    guardian = Guardian(request["settings"]["hardware"]["loop"]["stalled_s"], messages)
    try:
        if request["what"] == "check":
            check_rig(request["settings"], request["armed"], guardian)
        else:
            record(**request["run"], settings=request["settings"], guardian=guardian)
    except FprcError as error:
        log.error("error: %s", error)
        return 1
    return 0


def record(
    name: str, raw: str, *, settings: Mapping[str, Any], model: str = "", guardian: Guardian
) -> None:
    """Run an experiment on the real rig and write its raw log.

    During the run its samples also go to a journal beside the log, named after the log and the
    time, which is kept. The log of a run that was stopped, or whose ``raw`` cannot be written, is
    beside the journal under another name, or among the temporary files; the ControlError names it.
    DeviceError: a part cannot be opened.
    """
    law, samples, planned, extra, hint = plan(name, settings, model)
    started = datetime.now(UTC)
    path = Path(raw).with_suffix(f".{started:%Y%m%d-%H%M%S}.journal")
    seconds = samples / settings["control"]["sample_rate_hz"]
    log.info("%s, %.0f s; Ctrl-C stops it and vents%s", name, seconds, hint)
    attributes = planned | {"started": started.isoformat(timespec="microseconds")}
    journal = Journal(path, (*RAW_CHANNELS, *extra), attributes)
    try:
        channels, statistics, stopped, unvented = on_rig(
            settings, law, samples, guardian, extra=extra, keep=journal.append
        )
    except BaseException as error:
        with suppress(LogError):
            journal.close(f"{type(error).__name__}: {error}")
        raise
    stopped = "\n".join(filter(None, [stopped, unvented]))
    try:
        journal.close(stopped, **statistics)
    except LogError as error:
        if str(error) not in stopped:
            log.warning("%s", error)
    attributes |= state_of(stopped, statistics)
    recorded, rescued = len(channels["time_s"]), path.with_suffix(".rescued.h5")
    places = [rescued, Path(tempfile.gettempdir(), rescued.name)]
    if not stopped:
        places.insert(0, Path(raw))
    why, where = [stopped], f"{path} has what it can of the {recorded} samples"
    for place in places if recorded else []:
        try:
            place.parent.resolve(strict=True)  # a folder that is gone is not made again
            refuse_output(place, ".h5")
            write_raw(place, channels, **attributes)
        except (FprcError, OSError) as error:
            why.append(str(error))
            continue
        if place == Path(raw):
            log.info("%d samples, %d ticks missed; wrote %s", recorded, statistics["overruns"], raw)
            return
        where = f"{place} has the {recorded} samples"
        break
    shown = "" if unvented else "; both chambers are vented, as their sensors show"
    raise ControlError("\n".join(filter(None, [*why, f"{where}{shown}"])))


if __name__ == "__main__":
    sys.exit(main())
