"""Look at logs outside the workflow."""

import json
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from fprc.config import Settings
from fprc.errors import LogError
from fprc.logs import assess, read_raw
from fprc.logs.isolated import attempt_each
from fprc.logs.quality import warnings


def inspect_logs(paths: Sequence[str]) -> int:
    """Print the quality record of each raw log; return 1 if one is not clean.

    The limits are the default ones; the sample rate is each log's own.
    """
    failed = False
    limits = Settings().quality.model_dump()
    for record in attempt_each(_record, paths, limits=limits):
        if isinstance(record, LogError):
            print(f"error: {record}", file=sys.stderr)
            failed = True
            continue
        print(json.dumps(record, indent=2))
        for warning in warnings(record):
            print(f"warning: {warning}", file=sys.stderr)
            failed = True
    return int(failed)


def _record(path: str, limits: Mapping[str, Any]) -> dict[str, Any]:
    log = read_raw(
        path, experiment=None, sample_rate_hz=None, rate_tolerance=limits["rate_tolerance"]
    )
    return assess(log, sample_rate_hz=log.attributes["sample_rate_hz"], **limits)
