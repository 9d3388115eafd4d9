"""Snakemake's logger ``fprc``: a line for each job, a bar on a terminal, errors in full.

The profile of the workflow chooses it. A dry run, ``--verbose``, ``--printshellcmds`` and
FPRC_MESSAGES=all in the environment print what Snakemake prints without it. Snakemake's own log
file, below .snakemake/log, has everything.
"""

import logging
import os
import re
import sys
import threading
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from snakemake.logging import ColorizingTextHandler, DefaultFilter, DefaultFormatter
from snakemake.settings.enums import Quietness
from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from snakemake_logger_plugin_fprc.progress import (
    Progress,
    read_seconds,
    write_seconds,
)

#: Names of targets, for the message on one that does not exist; the Snakefile adds them.
KNOWN_TARGETS: set[str] = set()

#: File with the durations of earlier runs; the Snakefile adds one for its folder of results.
SECONDS = [Path(".snakemake/seconds.json")]

#: Beginnings of messages that say nothing about this run's results.
_ROUTINE = (
    "Assuming unrestricted",
    "Building DAG",
    "Complete log",
    "Elapsed time",
    "Execute ",
    "Select jobs",
    "Singularity containers",
    "Using ",
)

#: What Snakemake prints if a file of --configfile is missing: a traceback.
_NO_FILE = re.compile(r"(?s)in load_configfile\n.*No such file or directory: '(.+)'")


class LogHandler(LogHandlerBase):
    """Prints Snakemake's events; runs in the thread of its queue."""

    def __post_init__(self) -> None:
        """Choose between lines for jobs and Snakemake's output."""
        asked = self.common_settings
        stream = sys.stdout if asked.stdout else sys.stderr
        self._own = ColorizingTextHandler(nocolor=asked.nocolor, stream=stream)
        self._own.setFormatter(DefaultFormatter(asked.quiet, asked.show_failed_logs))
        self._own.addFilter(
            DefaultFilter(
                quiet=asked.quiet,
                debug_dag=asked.debug_dag,
                verbose=asked.verbose,
                dryrun=asked.dryrun,
                printshellcmds=asked.printshellcmds,
            )
        )
        wordy = asked.dryrun or asked.verbose or asked.printshellcmds or asked.debug_dag
        quiet = not {Quietness.ALL, Quietness.PROGRESS, Quietness.RULES}.isdisjoint(
            asked.quiet or ()
        )
        wordy = wordy or quiet or os.environ.get("FPRC_MESSAGES") == "all"
        self._progress = None if wordy else Progress(stream, stream.isatty())
        self._ended = threading.Event()
        self._lock = threading.RLock()
        if self._progress:
            # jobs leave the terminal to this handler, warnings apart
            os.environ["FPRC_MESSAGES"] = "log"

    def emit(self, record: logging.LogRecord) -> None:
        """Print a record in words; an error here must not end the thread."""
        try:
            self._print(record)
        except Exception:
            self.handleError(record)

    def _print(self, record: logging.LogRecord) -> None:
        message: dict[str, Any] = vars(record)
        event = message.get("event")
        if missing := _NO_FILE.search(record.getMessage()):
            self._own.stream.write(
                f"{missing[1]}: no such configuration file. If it is a target, put it before "
                "--configfile, which takes every word after it.\n"
            )
        elif self._progress is None:
            self._own.handle(record)
            self._suggest(record.getMessage())
        elif event == LogEvent.RUN_INFO:
            jobs = {rule: count for rule, count in message["stats"].items() if rule != "total"}
            self._progress.seconds = read_seconds(SECONDS[-1])
            self._progress.begin(jobs)
            threading.Thread(target=self._tick, args=[self._progress], daemon=True).start()
        elif event == LogEvent.JOB_INFO:
            log = Path(message["log"][0]) if message["log"] else None
            label = message["rule_msg"] or ""
            self._progress.start(message["jobid"], message["rule_name"], label, log)
        elif event == LogEvent.JOB_FINISHED:
            self._progress.finish(message["job_id"])
        elif event in (LogEvent.JOB_ERROR, LogEvent.GROUP_ERROR, LogEvent.ERROR) or (
            event is None and not record.getMessage().startswith(_ROUTINE)
        ):
            if event == LogEvent.JOB_ERROR:
                self._progress.running.pop(message["jobid"], None)
            self._progress.end()
            self._own.handle(record)
            self._suggest(record.getMessage())

    def _suggest(self, message: str) -> None:
        """Name the target that was meant, if Snakemake knows no such rule."""
        for asked in re.findall(r"No rule to produce (\w+) ", message):
            for near in get_close_matches(asked, KNOWN_TARGETS, n=1):
                self._own.stream.write(f"Did you mean {near}?\n")

    def close(self) -> None:
        """Remove the bar, and keep the durations of this run."""
        if self._progress and not self._ended.is_set():
            self._ended.set()
            self._progress.end()
            if self._progress.measured:
                write_seconds(SECONDS[-1], read_seconds(SECONDS[-1]), self._progress.measured)
        super().close()

    def _tick(self, progress: Progress) -> None:
        while not self._ended.wait(1.0):
            with self._lock:
                progress.show()

    def handle(self, record: logging.LogRecord) -> bool:
        """Handle one record at a time, and not while the bar is drawn."""
        with self._lock:
            return super().handle(record)

    @property
    def writes_to_stream(self) -> bool:
        """Replaces Snakemake's output."""
        return True

    @property
    def writes_to_file(self) -> bool:
        """Leaves Snakemake's log file alone."""
        return False

    @property
    def has_filter(self) -> bool:
        """Chooses what to print itself."""
        return True

    @property
    def has_formatter(self) -> bool:
        """Formats its lines itself."""
        return True

    @property
    def needs_rulegraph(self) -> bool:
        """Needs no graph."""
        return False
