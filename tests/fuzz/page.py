"""The counts of a run as a Markdown page."""

from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from judging import FAULTS, GOOD

_HEAD = """\
# Damaged and odd files

Written by `make fuzz PAGE=docs/fuzz.md`: seed {seed}, {cases} cases. Each case is a file, or two,
made of the seed and the number of the case alone; `python tests/fuzz --seed {seed} --case 4711`
repeats one and shows what was said. The commands are those of a user, in a process that is watched.

- *refused*: the exit code says so, a message names the file (in a configuration: or a key), and
  nothing is left behind
- *same*: what comes out is what was written before the damage; where a file has no checksums, as a
  CSV file, what another reader finds in it
- *different but said*: something is lost or not right, and a warning or its name says so
- *traceback*: or the process crashed
- *hang*: not done after 10 s of a processor or 30 s by the clock, a dry run after 60 s by the clock
- *over 1 GB*: of memory, the command's children included
- *accepted in silence*: what comes out is something else, or must not be accepted, and no line says
  so
- *untidy*: refused without naming the file, something left behind, a file changed, control
  characters on the terminal, a library's warning, NaN in what is printed; or refused though nothing
  is wrong with it

The files:

- *configuration*: other values, keys twice or unknown, deep, endless, bytes changed, folders that
  must not be used
- *journal*: bytes changed, cut, zeros, samples exchanged, repeated or of another run, other headers
- *raw log*, simulated, of a closed loop, imported or recorded; *flipped bytes*: one to three, in
  numbers or in metadata; *torn*: cut, zeros, noise, stretches taken out, exchanged, repeated;
  *other content*: samples, channels, units, types, shapes, attributes, links and sizes changed by
  way of HDF5, a fifth of them so that nothing is wrong with the result
- *recording*: quotes, separators, headers, fields, clocks, MATLAB's classes and shapes, bytes
  changed; maps that are wrong
- *dry run*: such configurations and logs

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
