"""Run a stage on behalf of a Snakemake rule."""

import logging
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from fprc.artifacts import explaining
from fprc.errors import FprcError
from fprc.escape import TerminalFormatter

log = logging.getLogger("fprc")

_NOT_OURS = ("code", "sidecar")


def run_stage(stage: Callable[..., Any], job: Any) -> Any:
    """Call ``stage`` with a rule's named inputs, outputs and params as arguments.

    Progress goes to the terminal and to the rule's log file. An error that is
    meant for people ends the process with its message alone and exit code 1; the
    log file has the traceback too.
    Numerical libraries run on one thread, so that results do not depend on the
    machine's load and two jobs do not fight for two cores.

    Parameters
    ----------
    job : snakemake object of a ``script:``
        The ``code`` param, the fingerprint of the source, is not passed on, nor is the
        output ``sidecar``, which the stage does not write.

    Returns
    -------
    object
        What the stage returns.
    """
    named = [*job.input.items(), *job.output.items(), *job.params.items()]
    arguments = {name: value for name, value in named if name not in _NOT_OURS}
    try:
        _log_to(job.log[0], " ".join([job.rule, *job.wildcards]))
        with threadpool_limits(1):
            return stage(**arguments)
    except FprcError as error:
        log.error("error: %s", error)
        log.debug("where it came from:", exc_info=True)
        sys.exit(1)


def _log_to(path: str, label: str) -> None:
    line = TerminalFormatter(f"[{label}] %(message)s")
    log.setLevel(logging.DEBUG)
    _add(logging.StreamHandler(), line, logging.INFO)
    with explaining(path):
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        file = logging.FileHandler(path, mode="w")
    file.handleError = lambda record: None  # on a full disk the terminal still has it
    _add(file, line)


def _add(handler: logging.Handler, line: logging.Formatter, level: int = logging.DEBUG) -> None:
    handler.setLevel(level)
    handler.setFormatter(line)
    log.addHandler(handler)
