"""Blocks of pages that are made from results: their markers, and the sentences of the README."""

import re
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from itertools import zip_longest
from pathlib import Path

import pandas as pd

from fprc.artifacts import read_json
from fprc.claims.paper import TIMED
from fprc.errors import FprcError
from fprc.escape import typeset
from fprc.paper import ERRORS
from fprc.registry import title_of
from fprc.tables.found import found
from fprc.tables.models import deviations


def readme_blocks(pages: Sequence[str], seeds: Sequence[str], ledger: str) -> dict[str, str]:
    """Return the blocks of the README that the paper's workflow makes; see ``update_readme``."""
    # without those on execution times, which vary from run to run
    claims = [claim for claim in read_json(ledger)["claims"] if claim["rig"] != TIMED]
    (sentence,) = found(claims, {}, simulated=True) or ("No claim is judged.",)
    shown = {path.stem: path.read_text(encoding="utf-8") for path in map(Path, pages)}
    blocks = {
        **{name: shown[name] for name in ("table2_seeds", "table4_seeds")},
        "outcome": f"- **{sentence.removesuffix('.')}** ([each of them](docs/results.md)).\n"
        f"- {deviations_sentence(seeds[:2])} {_tracking(seeds[2])}",
    }
    return {name: typeset(block) for name, block in blocks.items()}


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


def deviations_sentence(seeds: Sequence[str]) -> str:
    """Return a sentence on how far the means over seeds deviate from the printed numbers."""
    table = deviations(dict(zip(("II", "III"), map(pd.read_csv, seeds), strict=True)))
    worst = table.iloc[0]
    return (
        f"The {len(table)} means of Tables II and III deviate from the printed numbers by "
        f"{100 * table['deviation'].abs().median():.0f} % in the median and by "
        f"{100 * abs(worst['deviation']):.0f} % at most (Table {worst['table']}, "
        f"{title_of(worst['model'])}, {ERRORS[worst['metric']]}: {worst['mean']:.3g} against "
        f"{worst['published_mean']:.3g} kPa)."
    )


def _tracking(seeds: str) -> str:
    """Return a sentence on how far the means of Table IV deviate from the printed numbers."""
    table = pd.read_csv(seeds).dropna(subset="published_rmse_deg")
    table["off"] = (table["rmse_deg"] / table["published_rmse_deg"] - 1.0).abs()
    runs = table.groupby("controller")["off"].max()
    open_loop, closed_loop = runs["fprc"], runs["fprc_pd"]
    return (
        f"Those of Table IV deviate by up to {100 * open_loop:.0f} % in open loop, and by up to "
        f"{100 * closed_loop:.0f} % in closed loop, which was predicted."
    )
