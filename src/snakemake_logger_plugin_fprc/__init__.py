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
from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from snakemake_logger_plugin_fprc.progress import (
    Progress,
    read_seconds,
    write_seconds,
)

#: Names of targets, for the message on one that does not exist; the Snakefile adds them.
KNOWN_TARGETS: set[str] = set()

#: Durations of earlier runs.
_SECONDS = Path(".snakemake/seconds.json")

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


class LogHandler(LogHandlerBase):
    """Prints Snakemake's events; runs in the thread of its queue."""

    def __post_init__(self) -> None:
        """Choose between lines for jobs and Snakemake's own output."""
        asked = self.common_settings
        stream = sys.stdout if asked.stdout else sys.stderr
        self._own = ColorizingTextHandler(nocolor=asked.nocolor, stream=stream)
        self._own.setFormatter(DefaultFormatter(asked.quiet, asked.show_failed_logs))
        self._own.addFilter(
            DefaultFilter(
                asked.quiet, asked.debug_dag, asked.verbose, asked.dryrun, asked.printshellcmds
            )
        )
        wordy = asked.dryrun or asked.verbose or asked.printshellcmds or asked.debug_dag
        wordy = wordy or os.environ.get("FPRC_MESSAGES") == "all"
        self._progress = None if wordy else Progress(stream, stream.isatty())
        self._ended = threading.Event()
        self._lock = threading.RLock()
        if self._progress:
            # jobs leave the terminal to this handler, warnings apart
            os.environ["FPRC_MESSAGES"] = "log"

    def emit(self, record: logging.LogRecord) -> None:
        """Print what a record means to a person."""
        said: dict[str, Any] = vars(record)
        event = said.get("event")
        if self._progress is None:
            self._own.handle(record)
            self._suggest(record.getMessage())
        elif event == LogEvent.RUN_INFO:
            jobs = {rule: count for rule, count in said["stats"].items() if rule != "total"}
            self._progress.seconds = read_seconds(_SECONDS)
            self._progress.begin(jobs)
            threading.Thread(target=self._tick, args=[self._progress], daemon=True).start()
        elif event == LogEvent.JOB_INFO:
            log = Path(said["log"][0]) if said["log"] else None
            label = said["rule_msg"] or ""
            self._progress.start(said["jobid"], said["rule_name"], label, log)
        elif event == LogEvent.JOB_FINISHED:
            self._progress.finish(said["job_id"])
        elif event in (LogEvent.JOB_ERROR, LogEvent.GROUP_ERROR, LogEvent.ERROR) or (
            event is None and not record.getMessage().startswith(_ROUTINE)
        ):
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
                write_seconds(_SECONDS, self._progress.seconds, self._progress.measured)
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
        """Replaces Snakemake's own output."""
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
        """Words its lines itself."""
        return True

    @property
    def needs_rulegraph(self) -> bool:
        """Needs no graph."""
        return False
