"""`fprc config` and `fprc log`: check configuration and logs, and convert journals to raw logs."""

import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from fprc.apparatus.journal import recover
from fprc.config import from_files
from fprc.config.load import RIG, rig_file
from fprc.config.settings import Quality
from fprc.errors import LogError
from fprc.given import read_given
from fprc.logs import assess, read_raw
from fprc.logs.quality import warnings
from fprc.paper import SOURCES

#: Exit codes of `log repair`; if nothing can be read, it is 1.
COMPLETE, SOME_LOST = 0, 3


def check_config(files: Sequence[str]) -> str:
    """Check configuration files, merged in this order."""
    from_files(files)
    return "no errors\n"


def show_rig(name: str | None = None) -> str:
    """Return the file with the parameters of a fitted rig."""
    return read_given(rig_file(name or RIG)).decode(errors="backslashreplace")


def check_logs(paths: Sequence[str]) -> int:
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
        print(*_page(path, record), sep="\n")
        failed = failed or bool(warnings(record))
    return int(failed)


def _page(path: str, record: Mapping[str, Any]) -> Iterator[str]:
    """Yield the lines of a quality record."""
    checks, failed = record["checks"], len(warnings(record))
    verdict = f"{failed} of {len(checks)} checks failed" if failed else "all checks passed"
    yield (
        f"{path}: {record['experiment']}, {SOURCES[record['source']]}, {record['samples']} samples "
        f"at {record['sample_rate_hz']:g} Hz; {verdict}"
    )
    for name, check in checks.items():
        result = "ok" if check["passed"] else "FAILED"
        yield f"  {name:21} {result:6} {check['finding']}".rstrip()
    more = dict(record.get("notes", {}))
    if loop := record.get("loop"):
        shown = (f"{key} {f'{v:.3g}' if isinstance(v, float) else v}" for key, v in loop.items())
        more["loop"] = ", ".join(shown)
    yield from (f"  {name:28} {text}" for name, text in more.items())


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
