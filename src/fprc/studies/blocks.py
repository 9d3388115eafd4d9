"""Blocks of pages that are made from results, between two markers."""

import re
from collections.abc import Iterator, Mapping
from decimal import Decimal
from itertools import zip_longest
from pathlib import Path

from fprc.errors import FprcError
from fprc.escape import typeset


def with_blocks(path: str, blocks: Mapping[str, str]) -> str:
    """Return the text of a page with what its blocks should hold; in README.md it is typeset."""
    text = Path(path).read_text(encoding="utf-8")
    for name, block in blocks.items():
        if f"<!-- {name}: " in text:
            new = typeset(block) if Path(path).name == "README.md" else block
            text = replace_block(text, name, new, path)
    return text


def replace_block(text: str, name: str, block: str, path: str = "README.md") -> str:
    """Return ``text`` with the lines between the markers of ``name`` replaced.

    Raises
    ------
    FprcError
        The two markers do not occur exactly once each.
    """
    begin, end = f"<!-- {name}: generated -->", f"<!-- {name}: end -->"
    if not (text.count(begin) == text.count(end) == 1 and text.index(begin) < text.index(end)):
        raise FprcError(f"{path}: needs the lines {begin} and {end} once each; put them back")
    before, _, rest = text.partition(begin)
    return f"{before}{begin}\n{block.strip()}\n{end}{rest.partition(end)[2]}"


def different_lines(path: str, blocks: Mapping[str, str]) -> Iterator[str]:
    """Yield what the first line is that differs from ``with_blocks``, if one does.

    The last digit of a number may differ by one, as it does on another processor.
    """
    texts = Path(path).read_text(encoding="utf-8"), with_blocks(path, blocks)
    lines = zip_longest(*(text.splitlines() for text in texts), fillvalue="")
    for number, (is_now, would_be) in enumerate(lines, start=1):
        if not _same(is_now, would_be):
            yield f"{path}, line {number}: {is_now!r} would be {would_be!r}"
            return


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
