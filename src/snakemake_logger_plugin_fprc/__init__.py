"""Snakemake's logger ``fprc``: Snakemake's own output, with two of its errors in words.

The profile of the workflow chooses it. A target that does not exist is answered by the nearest one,
or by the Snakefile of the studies; a target that --configfile took for a file is explained, where
Snakemake prints a traceback.
"""

import logging
import re
from difflib import get_close_matches

from snakemake.logging import logger
from snakemake_interface_logger_plugins.base import LogHandlerBase

#: Names of targets; the Snakefile adds them.
KNOWN_TARGETS: set[str] = set()

_NO_FILE = re.compile(r"(?s)in load_configfile\n.*No such file or directory: '(.+)'")
_NO_RULE = re.compile(r"No rule to produce (\w+) ")


def put_in_words(record: logging.LogRecord) -> bool:
    """Change the message of the two errors; a filter that lets every record pass."""
    message = record.getMessage()
    if missing := _NO_FILE.search(message):
        record.msg = (
            f"{missing[1]}: no such configuration file. If it is a target, put it before "
            "--configfile, which takes every word after it."
        )
    elif asked := _NO_RULE.search(message):
        near = get_close_matches(asked[1], KNOWN_TARGETS, n=1)
        hint = (
            f"Did you mean {near[0]}?"
            if near
            else "docs/running.md lists the targets; those of the studies need --snakefile "
            "workflow/studies/Snakefile."
        )
        record.msg = f"{message}\n{hint}"
    return True


class LogHandler(LogHandlerBase):
    """Changes messages before Snakemake prints them, and prints nothing itself."""

    writes_to_stream = writes_to_file = property(lambda self: False)
    has_filter = has_formatter = needs_rulegraph = property(lambda self: False)

    def __post_init__(self) -> None:
        """Put the filter on Snakemake's logger."""
        logger.addFilter(put_in_words)

    def emit(self, record: logging.LogRecord) -> None:
        """Leave the record to Snakemake."""
