"""Blocks of pages that are made from results: their markers, and those of the README."""

import re
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from itertools import zip_longest
from pathlib import Path

from fprc.errors import FprcError
from fprc.escape import typeset

#: Tables of the README.
README_TABLES = ("table2_seeds", "table4_seeds")


def readme_blocks(pages: Sequence[str]) -> dict[str, str]:
    """Return the generated blocks of the README from the tables of the report."""
    shown = {path.stem: path for path in map(Path, pages)}
    return {name: typeset(shown[name].read_text(encoding="utf-8")) for name in README_TABLES}


def replace_block(text: str, name: str, block: str, path: str = "README.md") -> str:
    """Return ``text`` with the lines between the markers of ``name`` replaced.

    Raises
    ------
    FprcError
        The two markers do not occur exactly once each.
    """
    begin, end = _markers(text, name, path)
    before, _, rest = text.partition(begin)
    return f"{before}{begin}\n{block.strip()}\n{end}{rest.partition(end)[2]}"


def different_blocks(path: str, blocks: Mapping[str, str]) -> Iterator[str]:
    """Yield a line for each block of a page that differs from what the results give.

    The last digit of a number may differ by one, as it does on another processor.
    """
    text = Path(path).read_text(encoding="utf-8")
    for name, new in blocks.items():
        begin, end = _markers(text, name, path)
        old = text.partition(begin)[2].partition(end)[0].strip()
        lines = zip_longest(old.splitlines(), new.strip().splitlines(), fillvalue="")
        for number, (is_now, would_be) in enumerate(lines, start=1):
            if not _same(is_now, would_be):
                yield f"{path}, block {name}, line {number}: {is_now!r} would be {would_be!r}"
                break


_NUMBER = re.compile(r"(\d+(?:\.\d+)?)")


def _same(one: str, other: str) -> bool:
    """Return whether two lines are the same but for the last digits of their numbers."""
    parts, others = _NUMBER.split(one), _NUMBER.split(other)
    if parts[::2] != others[::2]:
        return False
    pairs = zip(parts[1::2], others[1::2], strict=True)
    return all(abs(Decimal(a) - Decimal(b)) <= max(_last(a), _last(b)) for a, b in pairs)


def _last(number: str) -> Decimal:
    """Return the size of the last digit."""
    return Decimal(1).scaleb(-len(number.partition(".")[2]))


def _markers(text: str, name: str, path: str) -> tuple[str, str]:
    begin, end = f"<!-- {name}: generated -->", f"<!-- {name}: end -->"
    if not (text.count(begin) == text.count(end) == 1 and text.index(begin) < text.index(end)):
        raise FprcError(f"{path}: needs the lines {begin} and {end} once each; put them back")
    return begin, end
