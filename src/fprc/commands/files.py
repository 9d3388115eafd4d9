"""`fprc config` and `fprc log`: check configuration and logs, and convert journals to raw logs."""

import sys
from collections.abc import Sequence

from fprc.apparatus.journal import read_journal
from fprc.artifacts import refuse_output
from fprc.config import from_files
from fprc.config.load import RIG, rig_file
from fprc.config.settings import Quality
from fprc.errors import LogError
from fprc.given import read_given
from fprc.logs import assess, read_raw, write_raw
from fprc.logs.quality import warnings
from fprc.paper import SOURCES


def check_config(files: Sequence[str]) -> str:
    """Check configuration files, merged in this order."""
    from_files(files)
    return "no errors\n"


def show_rig(name: str | None = None) -> str:
    """Return the file with the parameters of a fitted rig."""
    return read_given(rig_file(name or RIG)).decode(errors="backslashreplace")


def check_logs(paths: Sequence[str]) -> int:
    """Check raw logs and say what is wrong with them."""
    limits, code, tolerance = Quality(), 0, Quality().rate_tolerance
    for path in paths:
        try:
            log = read_raw(path, experiment=None, sample_rate_hz=None, rate_tolerance=tolerance)
        except LogError as error:
            print(f"error: {error}", file=sys.stderr)
            code = 1
            continue
        record = assess(log, limits, log.attributes["sample_rate_hz"])
        checks, failed = record["checks"], len(warnings(record))
        verdict = f"{failed} of {len(checks)} checks failed" if failed else "all checks passed"
        print(
            f"{path}: {record['experiment']}, {SOURCES[record['source']]}, {record['samples']} "
            f"samples at {record['sample_rate_hz']:g} Hz; {verdict}"
        )
        for name, check in checks.items():
            result = "ok" if check["passed"] else "FAILED"
            print(f"  {name:21} {result:6} {check['finding']}".rstrip())
        more = dict(record.get("notes", {}))
        if loop := record.get("loop"):
            shown = [f"{k} {f'{v:.3g}' if isinstance(v, float) else v}" for k, v in loop.items()]
            more["loop"] = ", ".join(shown)
        for name, text in more.items():
            print(f"  {name:28} {text}")
        if failed:
            code = 1
    return code


def repair(source: str, *, out: str) -> int:
    """Recover a raw log from the journal of a run, which is not changed; 3: samples may be lost."""
    refuse_output(out, ".h5")
    channels, attributes, closed = read_journal(source)
    samples = len(next(iter(channels.values())))
    if not samples:
        raise LogError(f"{source}: no sample can be read; nothing was written")
    try:
        write_raw(out, channels, **attributes)
    except (TypeError, ValueError) as error:  # of what was forged
        raise LogError(f"{source}: what it says of the run fits no log ({error})") from error
    whole = closed and not attributes["lost_samples"]
    said = [f"{out}: {samples} samples from {source}", attributes.get("incomplete_reason", "")]
    print("; ".join(filter(None, [*said, "nothing is lost" if whole else ""])))
    return 0 if whole else 3
