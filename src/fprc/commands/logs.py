"""`fprc log`: check raw logs, and convert journals to raw logs."""

import sys
from collections.abc import Mapping, Sequence
from typing import Any

from fprc.apparatus.journal import recover
from fprc.config.settings import Quality
from fprc.errors import LogError
from fprc.logs import assess, read_raw
from fprc.logs.quality import warnings
from fprc.paper import SOURCES

#: Exit codes of `log repair`; if nothing can be read, it is 1.
COMPLETE, SOME_LOST = 0, 3


def check(paths: Sequence[str]) -> int:
    """Check raw logs and say what is wrong with them."""
    limits, failed = Quality(), False
    how: dict[str, Any] = {"sample_rate_hz": None, "rate_tolerance": limits.rate_tolerance}
    for path in paths:
        try:
            log = read_raw(path, experiment=None, **how)
            record = assess(log, limits, log.attributes["sample_rate_hz"])
        except LogError as error:
            print(f"error: {error}", file=sys.stderr)
            failed = True
            continue
        print("\n".join(_page(path, record)))
        failed = failed or bool(warnings(record))
    return int(failed)


def _page(path: str, record: Mapping[str, Any]) -> list[str]:
    """Return a quality record as lines for people."""
    checks = record["checks"]
    failed = sum(not check["passed"] for check in checks.values())
    verdict = f"{failed} of {len(checks)} checks failed" if failed else "all checks passed"
    lines = [
        f"{path}: {record['experiment']}, {SOURCES[record['source']]}, {record['samples']} samples "
        f"at {record['sample_rate_hz']:g} Hz; {verdict}"
    ]
    for name, check in checks.items():
        result = "ok" if check["passed"] else "FAILED"
        lines.append(f"  {name:21} {result:6} {check['finding']}".rstrip())
    for channel, note in record.get("notes", {}).items():
        lines.append(f"  {channel:28} {note}")
    if statistics := record.get("loop"):
        shown = (
            f"{key} {v:.3g}" if isinstance(v, float) else f"{key} {v}"
            for key, v in statistics.items()
        )
        lines.append(f"  {'loop':28} {', '.join(shown)}")
    return lines


def repair(source: str, *, out: str) -> int:
    """Recover a raw log from the journal of a run."""
    findings = recover(source, out)
    whole = findings.closed and not findings.lost
    print(f"{out}: {findings.samples} samples from {source}")
    if findings.reason:
        print(f"  incomplete: {findings.reason}")
    if whole:
        print("  nothing is lost")
    return COMPLETE if whole else SOME_LOST
