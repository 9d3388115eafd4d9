"""The process that drives a real rig; started and supervised by ``fprc.apparatus.guardian``.

From standard input it reads a request, one line of JSON, and then the guardian's heartbeats; it
stops when these cease or the input is closed. To standard output it writes ``OPENING`` before it
opens the boards, ``ARMED`` before anything can move, then heartbeats, and ``SAFE`` once the rig is
released and readings show it vented.
"""

import gc
import json
import logging
import sys
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from fprc.apparatus.check import check_rig
from fprc.apparatus.journal import Journal
from fprc.apparatus.programme import plan
from fprc.apparatus.recovery import difference, recover, rescue
from fprc.apparatus.session import Stop, on_rig, reserve_pipes
from fprc.channels import RAW_CHANNELS
from fprc.control import RunAbortedError
from fprc.errors import FprcError, LogError

log = logging.getLogger("fprc.rig")

_READ_ONLY = 0o444


def main() -> int:
    """Carry out the request; return the exit code."""
    logging.basicConfig(level=logging.INFO, format="[rig] %(message)s")
    # unbuffered, because the bytes after the line are heartbeats
    with open(0, "rb", buffering=0, closefd=False) as unbuffered:
        request = json.loads(unbuffered.readline())
    reserve_pipes()
    gc.disable()  # a collection may take longer than a tick
    stop = Stop(request["settings"]["hardware"]["loop"]["stalled_s"])
    try:
        if request["what"] == "check":
            return check_rig(request["settings"], request["armed"], stop)
        record(**request["run"], settings=request["settings"], stop=stop)
    except FprcError as error:
        log.error("error: %s", error)
        return 1
    return 0


def record(
    name: str,
    raw: str,
    *,
    settings: Mapping[str, Any],
    model: str = "",
    stop: Stop,
) -> None:
    """Run an experiment on the real rig and write its raw log, read-only.

    The run writes its samples to a journal beside the log, named after the log and the time,
    which is kept.

    Raises
    ------
    ControlError, DeviceError
        The run was refused or stopped, or its journal does not hold the samples that are in memory;
        names the journal, or the log that replaces it.
    """
    experiment = plan(name, settings, model)
    stamp = datetime.now(UTC).strftime("%Y%m%d-%H%M%S")
    path = Path(raw).with_suffix(f".{stamp}.journal")
    period_s = 1.0 / settings["control"]["sample_rate_hz"]
    seconds, tenth = experiment.samples * period_s, max(experiment.samples // 10, 1)
    log.info("%s, %.0f s; Ctrl-C stops it and vents", name, seconds)
    if experiment.hint:
        log.info("%s", experiment.hint)
    with Journal(path, experiment.channels, experiment.attributes) as journal:

        def keep(tick: int, row: Sequence[float]) -> None:
            journal.append(tick, row)
            if tick % tenth == 0:  # from 0 s, the start, on; a missed tick tells nothing
                log.info("%.3g of %.3g s", tick * period_s, seconds)

        extra = experiment.channels[len(RAW_CHANNELS) :]
        channels, statistics, stopped, unvented = on_rig(
            settings, experiment.law, experiment.samples, stop, extra=extra, keep=keep
        )
        if unvented:
            complete = "the samples are complete, but the rig was not closed: "
            stopped = (f"{stopped}\n" if stopped else complete) + unvented
        failed = ""
        try:
            journal.close(stopped, **statistics)
        except LogError as error:
            failed = str(error)
    failed = failed or difference(path, channels)
    kept = _kept(journal, channels, stopped, statistics, failed)
    if stopped or failed:
        why = stopped or "the run was complete, but not its log"
        if failed not in why:  # which holds that of a sample
            why += f"\n{failed}"
        shown = "" if unvented else "both chambers are vented, as their sensors show; "
        raise RunAbortedError(f"{why}\n{shown}{kept}", channels)
    try:
        recover(path, raw)
    except (FprcError, OSError) as error:
        raise LogError(f"{error}\nthe run was complete; {kept}") from error
    for file in (path, Path(raw)):
        file.chmod(_READ_ONLY)
    log.info(
        "%d samples, %d ticks missed, lateness %.3f ms median, %.3f ms at 99.9 %%; wrote %s",
        statistics["ticks"],
        statistics["overruns"],
        1e3 * statistics["jitter_p50_s"],
        1e3 * statistics["jitter_p99_9_s"],
        raw,
    )


def _kept(
    journal: Journal,
    channels: Mapping[str, np.ndarray],
    stopped: str,
    statistics: Mapping[str, float],
    failed: str,
) -> str:
    """Return where the samples of a closed journal are; if it failed, save them elsewhere."""
    path, recorded = journal.path, len(channels["time_s"])
    if not failed and not recorded:
        return f"no sample was recorded, and {path} can be deleted"
    if not failed:
        out = path.with_suffix(".rescued.h5")
        return (
            f"{recorded} samples are in {path}, copy them with: fprc log repair {path} --out {out}"
        )
    try:
        saved = rescue(journal, channels, reason=stopped, statistics=statistics)
    except LogError as error:
        return f"{path} may lack some of {recorded} samples, which can be saved nowhere:\n{error}"
    return f"{saved} has all of them, {recorded} samples"


if __name__ == "__main__":
    sys.exit(main())
