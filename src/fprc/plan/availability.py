"""Why a result cannot be made from the existing logs."""

from collections.abc import Mapping

from fprc.channels import unit_of
from fprc.escape import in_words, terminal
from fprc.logs import Columns
from fprc.logs.quality import substitute
from fprc.plan.results import BY_NAME, Result


def why_not(need: Result, logs: Mapping[str, Columns], folder: str) -> str | None:
    """Return why a result cannot be made from the logs; None if it can."""
    absent = [f"{name}.h5" for name in need.logs if name not in logs]
    if absent:
        verb = "is" if len(absent) == 1 else "are"
        return f"needs {in_words(absent)}, which {verb} not in {folder}"
    lacking: dict[tuple[str, ...], list[str]] = {}
    for name in need.logs:
        if channels := tuple(c for c in need.channels if c not in logs[name].names):
            lacking.setdefault(channels, []).append(f"{name}.h5")
    reasons = []
    for channels, files in lacking.items():
        verb = "does" if len(files) == 1 else "do"
        reasons.append(f"{in_words(channels)}, which {in_words(files)} {verb} not have")
    for name in need.literal:
        others = {log: substitute(name, logs[log].attributes) for log in need.logs}
        reasons += [
            f"{name} in {unit_of(name)}; in {log}.h5 it is {other}"
            for log, other in others.items()
            if other is not None
        ]
    return "needs " + "; and ".join(reasons) if reasons else None


def refusal(name: str, reasons: Mapping[str, str]) -> str:
    """Return the error message for a target that cannot be made."""
    title = BY_NAME[name].title
    return terminal(f"{name}: not available for this data: {title} {reasons[name]}")
