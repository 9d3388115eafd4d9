"""Judge the outcome of a command on a damaged file by its messages and its output files."""

import hashlib
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from fprc.cli import main

#: Limits of a command: CPU time and memory.
LIMIT_S = 10.0
LIMIT_BYTES = 1 << 30

REFUSED, SAME, SAID = "refused", "same", "different, reported"
TRACEBACK, HANG, MEMORY = "traceback", "hang", "over 1 GB"
SILENT, UNTIDY = "accepted silently", "untidy"
#: Allowed and forbidden outcomes.
GOOD = (REFUSED, SAME, SAID)
FAULTS = (TRACEBACK, HANG, MEMORY, SILENT, UNTIDY)

#: Control characters of a terminal, and characters that cannot be printed.
_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\udc80-\udcff]")
#: A Python warning of a library, which users should not see.
_LIBRARY = re.compile(r"^.*\b\w*Warning: .*$", re.MULTILINE)
_NO_NUMBER = re.compile(r"[:\[,]\s*-?(NaN|Infinity)\b")

Verdict = tuple[str, str]


class Ended(NamedTuple):
    """How a command ended: exit code, output, and peak memory with its children."""

    code: int
    out: str
    err: str
    peak_bytes: int = 0


class Step(NamedTuple):
    """One command that runs on the files of a case.

    Attributes
    ----------
    command : tuple of str
        Arguments of ``fprc``.
    row : str
        Line of the table.
    names : tuple of str
        A refusal must contain at least one of them.
    judge : callable
        Compares the output with the expected one if the command accepted the file.
    leaves : tuple of str
        Files that the command may write if it accepts.
    accepts : callable
        Whether the command accepted the file.
    call : callable
        What runs the command; it returns the exit code.
    limit_s : float
        Time limit.
    """

    command: tuple[str, ...]
    row: str
    names: tuple[str, ...]
    judge: Callable[[Path, Ended], Verdict]
    leaves: tuple[str, ...] = ()
    accepts: Callable[[Ended], bool] = lambda ended: ended.code == 0
    call: Callable[[tuple[str, ...]], int | None] = main
    limit_s: float = LIMIT_S


class Case(NamedTuple):
    """Files in a folder, and the commands that run on them.

    Attributes
    ----------
    sound : bool
        Whether the files are valid, so that a refusal is a fault.
    """

    kind: str
    what: str
    steps: list[Step]
    sound: bool = False


class Result(NamedTuple):
    """Outcome of one step."""

    row: str
    outcome: str
    why: str


def judged(step: Step, case: Case, folder: Path, before: dict[str, str], ended: Ended) -> Result:
    """Judge a step of a case by its output, and by what changed in the folder."""
    outcome, why = outcome_of(step, folder, before, ended)
    if case.sound and outcome == REFUSED:
        outcome, why = UNTIDY, f"refused though valid: {why}"
    return Result(step.row, outcome, why)


def outcome_of(step: Step, folder: Path, before: dict[str, str], ended: Ended) -> Verdict:
    said = ended.err + ended.out
    last = (ended.err.strip().splitlines() or [""])[-1]
    if ended.peak_bytes > LIMIT_BYTES:
        return MEMORY, f"{ended.peak_bytes >> 20} MB"
    if ended.code < 0:
        return TRACEBACK, f"ended by signal {-ended.code}"
    if "Traceback (most recent call last)" in said:
        return TRACEBACK, last
    after = content_of(folder)
    changed = sorted(name for name in before if after.get(name) != before[name])
    if changed:
        return UNTIDY, f"changed {', '.join(changed)}"
    accepted = step.accepts(ended)
    untidy = _untidy(ended) or _unnamed(step, accepted, said, last)
    left = sorted(set(after) - set(before) - set(step.leaves if accepted else ()))
    if left:
        untidy = f"left {', '.join(left)}; said {last[:200]}"
    if untidy:
        return UNTIDY, untidy
    if not accepted:
        return REFUSED, last
    try:
        return step.judge(folder, ended)
    except Exception as error:
        return SILENT, f"the output cannot be judged: {type(error).__name__}: {error}"


def _untidy(ended: Ended) -> str:
    for text in (ended.err, ended.out):
        if found := _CONTROL.search(text):
            return f"printed {found[0]!r}"
        if found := _LIBRARY.search(text):
            return f"a library's warning: {found[0][:200]}"
    if found := _NO_NUMBER.search(ended.out):
        return f"printed {found[1]}"
    return ""


def _unnamed(step: Step, accepted: bool, said: str, last: str) -> str:
    if accepted or any(name in said for name in step.names):
        return ""
    return f"refused without naming {' or '.join(step.names[:3])}: {last[:200]}"


def content_of(folder: Path) -> dict[str, str]:
    """Return the digest of each file in a folder, by name."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if path.is_file() and not path.is_symlink():
            found[name] = hashlib.sha256(path.read_bytes()).hexdigest()
        else:
            found[name] = "no file"
    return found


def differing(found: dict[str, Any], expected: dict[str, Any]) -> list[str]:
    """Return the names of arrays or values that differ or exist on one side only."""
    names = found.keys() | expected.keys()
    return sorted(
        name
        for name in names
        if name not in found or name not in expected or not _same(found[name], expected[name])
    )


def _same(one: Any, other: Any) -> bool:
    if hasattr(one, "tobytes") and hasattr(other, "tobytes"):
        return one.shape == other.shape and one.tobytes() == other.tobytes()
    return type(one) is type(other) and one == other
