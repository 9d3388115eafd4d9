"""The counts of a run as a Markdown page."""

from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from judging import FAULTS, GOOD

_HEAD = """\
# Damaged and odd files

Written by `make fuzz PAGE=docs/fuzz.md`: seed {seed}, {cases} cases. Each case is one or two files
that depend only on seed and number of the case; `python tests/fuzz --seed {seed} --case 4711`
repeats one and shows its output. The commands are a user's, with limits on time and memory.

- *refused*: a non-zero exit code, a message with the file (or a key of a configuration), and
  no file left behind
- *same*: the output has the values from before the damage; for files without checksums, such as
  CSV, the values that an independent reader finds
- *different, reported*: something is lost or wrong, and a warning or its name is printed
- *traceback*: a traceback or a crash
- *hang*: not done after 10 s of CPU time or 30 s wall-clock time, a dry run after 60 s wall-clock
- *over 1 GB*: memory, including the command's children
- *accepted silently*: a wrong output, or an invalid file that was accepted, without a message
- *untidy*: refused without naming the file, a file left behind or changed, control characters on
  the terminal, a library's warning, NaN in the output; or a valid file refused

The files:

- *configuration*: other values, duplicate or unknown keys, deep or endless nesting, changed bytes,
  forbidden folders
- *journal*: changed bytes, truncation, zeros, samples exchanged, repeated or from another run,
  other headers
- *raw log*, simulated, of a closed loop, imported or recorded; *flipped bytes*: one to three, in
  numbers or in metadata; *torn*: truncation, zeros, noise, parts removed, exchanged or repeated;
  *other content*: samples, channels, units, types, shapes, attributes, links and sizes changed
  through HDF5; a fifth of these changes give a valid log
- *model*: changed bytes, truncation, and values, arrays, links and sizes changed through HDF5; with
  *checksum renewed*, so that only the content can give it away, another whole model is *different*
- *recording*: quotes, separators, headers, fields, clocks, MATLAB's classes and shapes, changed
  bytes; wrong maps
- *dry run*: the same kinds of configurations and logs

"""


def table(cases: Counter, counts: Counter) -> list[str]:
    """Return the table of outcomes by kind of file and command, as Markdown."""
    columns = ("kind of file", "cases", "command", *GOOD, *FAULTS)
    lines = [columns, ["---"] * 3 + ["---:"] * (len(columns) - 3)]
    for kind in sorted(cases):
        shown = str(cases[kind])
        for row in sorted({row for one, row, _ in counts if one == kind}):
            each = [str(counts[kind, row, outcome]) for outcome in (*GOOD, *FAULTS)]
            lines.append([kind, shown, row, *each])
            shown = ""
    total = [sum(n for (_, _, o), n in counts.items() if o == one) for one in (*GOOD, *FAULTS)]
    lines.append(["all", str(sum(cases.values())), "", *map(str, total)])
    return [_line(cells) for cells in lines]


def times(counts: Counter, seconds: Counter) -> Iterable[str]:
    """Yield the mean time of each command on each kind of file."""
    for (kind, row), took_s in sorted(seconds.items()):
        number = sum(n for (one, other, _), n in counts.items() if (one, other) == (kind, row))
        yield f"{kind}, {row}: {number} times {took_s / number:.3f} s"


def write(page: str, seed: int, cases: Counter, counts: Counter) -> None:
    """Write the page."""
    head = _HEAD.format(seed=seed, cases=sum(cases.values()))
    Path(page).write_text(head + "\n".join(table(cases, counts)) + "\n", encoding="utf-8")


def _line(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"
