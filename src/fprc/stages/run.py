"""Run a stage on behalf of a Snakemake rule."""

import logging
import os
import sys
from pkgutil import resolve_name
from typing import Any

from pydantic import validate_call
from threadpoolctl import threadpool_limits

from fprc.errors import FprcError

log = logging.getLogger("fprc")

#: Inputs, outputs and params of a rule that are not arguments of its stage. ``made_from`` are
#: intermediate files: as inputs they prevent stale numbers after a failed job.
_NOT_ARGUMENTS = ("stage", "code", "captions", "made_from")


def run_stage(job: Any) -> None:
    """Call the stage of a rule with its named inputs, outputs and params as arguments.

    Params are plain data; pydantic makes the sections of them that the stage is annotated with.
    ``job`` is the object ``snakemake`` of a ``script:``; its param ``stage`` names the function.
    Progress goes to the rule's log file, and with FPRC_MESSAGES=all to the terminal too. An
    FprcError ends the process with exit code 1 and only its message; the traceback goes to the log
    file. Numerical libraries run on one thread, so that results do not depend on the number of
    cores and parallel jobs do not compete for them.
    """
    named = [*job.input.items(), *job.output.items(), *job.params.items()]
    arguments = {name: value for name, value in named if name not in _NOT_ARGUMENTS}
    try:
        _log_to(job.log[0], " ".join([job.rule, *job.wildcards]))
        # what loads OpenMP later reads this; its threads would wait for those of other jobs
        os.environ["OMP_NUM_THREADS"] = "1"
        # first: the limit applies to loaded libraries only
        module, _, function = job.params.stage.rpartition(".")
        stage = validate_call(resolve_name(f"fprc.{module}:{function}"))
        with threadpool_limits(1):
            stage(**arguments)
    except FprcError as error:
        log.error("error: %s", error)
        log.debug("traceback:", exc_info=True)
        sys.exit(1)


def _log_to(path: str, label: str) -> None:
    log.setLevel(logging.DEBUG)
    terminal = logging.StreamHandler()
    terminal.setLevel("INFO" if os.environ.get("FPRC_MESSAGES") == "all" else "WARNING")
    file = logging.FileHandler(path, mode="w")
    # ignore a full disk: the message is on the terminal too
    file.handleError = lambda record: None  # type: ignore[method-assign]
    for handler in (terminal, file):
        handler.setFormatter(logging.Formatter(f"[{label}] %(message)s"))
        log.addHandler(handler)
