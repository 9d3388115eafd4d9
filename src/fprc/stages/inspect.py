"""Look at logs outside the workflow."""

import json
import sys
from collections.abc import Sequence

from fprc.config import Settings
from fprc.errors import LogError
from fprc.escape import terminal
from fprc.logs import assess, read_raw
from fprc.logs.quality import warnings


def inspect_logs(paths: Sequence[str]) -> int:
    """Print the quality record of each raw log; return 1 if one is not clean.

    The limits are the default ones; the sample rate is each log's own.
    """
    limits = Settings().quality.model_dump()
    failed = False
    for path in paths:
        try:
            log = read_raw(
                path,
                experiment=None,
                sample_rate_hz=None,
                rate_tolerance=limits["rate_tolerance"],
            )
        except LogError as error:
            print(terminal(f"error: {error}"), file=sys.stderr)
            failed = True
            continue
        record = assess(log, sample_rate_hz=log.attributes["sample_rate_hz"], **limits)
        print(json.dumps(record, indent=2))
        for warning in warnings(record):
            print(terminal(f"warning: {warning}"), file=sys.stderr)
            failed = True
    return int(failed)
