"""Numbers of the results in the README and the pages of docs/: put there, and checked.

They stand in blocks between two markers.
"""

import logging
import re
from collections.abc import Mapping, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Any

import pandas as pd

from fprc.artifacts import replacing, write_text
from fprc.claims.ledger import KINDS, changed_verdicts, holding
from fprc.errors import FprcError
from fprc.escape import typeset
from fprc.given import read_json, read_yaml

log = logging.getLogger(__name__)

_NUMBER = re.compile(r"(\d+(?:\.\d+)?)")


def update_pages(
    figures: Sequence[str], *, pages: Sequence[str], pictures: Sequence[str], **tables: str
) -> None:
    """Replace the generated blocks of pages, and their pictures; all of them or none.

    ``tables`` are given by their blocks, in Markdown, those of claims as JSON. Each block is on the
    pages that have its marker, in README.md typeset; ``pictures`` are the copies of ``figures``.
    """
    blocks = {name: _read(table) for name, table in tables.items() if table.endswith(".md")}
    if "verdicts" in tables:
        judged = read_json(tables["verdicts"])
        blocks |= {"verdicts": _verdicts(judged), "held": _held(judged["claims"], tables)}
    texts = {path: with_blocks(path, blocks) for path in pages}
    for name in blocks:
        if not any(f"<!-- {name}: " in text for text in texts.values()):
            raise FprcError(f"{' and '.join(pages)}: the block {name} is missing; put it back")
    for path, text in texts.items():
        write_text(path, text)
    for figure, picture in zip(figures, pictures, strict=True):
        with replacing(picture) as temporary:
            temporary.write_bytes(Path(figure).read_bytes())


def check_results(ledger: str, verdicts: str, pages: Sequence[str] = ()) -> None:
    """Refuse verdicts other than the declared ones, and other numbers in README.md.

    ``pages`` are the tables of the report; without them README.md is not checked.
    """
    declared = {name: row["verdict"] for name, row in read_yaml(verdicts)["claims"].items()}
    problems = changed_verdicts(read_json(ledger)["claims"], declared)
    if problems:
        problems.insert(0, f"if these verdicts of {ledger} are right, declare them in {verdicts}:")
    if pages:
        problems += different_lines("README.md", {Path(page).stem: _read(page) for page in pages})
    if problems:
        raise FprcError("\n".join(problems))
    log.info("all %d verdicts are as declared", len(declared))


def _read(path: str) -> str:
    return Path(path).read_text(encoding="utf-8")


def with_blocks(path: str, blocks: Mapping[str, str]) -> str:
    """Return the text of a page with what its blocks should hold; in README.md it is typeset."""
    text = _read(path)
    for name, block in blocks.items():
        begin, end = f"<!-- {name}: generated -->", f"<!-- {name}: end -->"
        if f"<!-- {name}: " in text:
            before, *rest = re.split(f"{begin}.*?{end}", text, flags=re.DOTALL)
            if len(rest) != 1:
                raise FprcError(
                    f"{path}: needs the lines {begin} and {end} once each; put them back"
                )
            new = typeset(block) if Path(path).name == "README.md" else block
            text = f"{before}{begin}\n{new.strip()}\n{end}{rest[0]}"
    return text


def different_lines(path: str, blocks: Mapping[str, str]) -> list[str]:
    """Return what the first line is that differs from ``with_blocks``, if one does.

    The last digit of a number may differ by one, as it does on another processor.
    """
    texts = _read(path).splitlines(), with_blocks(path, blocks).splitlines()
    for number, (is_now, would_be) in enumerate(zip_longest(*texts, fillvalue=""), start=1):
        if not _same(is_now, would_be):
            why = f"{is_now!r} would be {would_be!r}; `make docs` puts it there"
            return [f"{path}, line {number}: {why}"]
    return []


def _same(one: str, other: str) -> bool:
    """Return whether two lines are the same but for the last digits of their numbers."""
    parts, others = _NUMBER.split(one), _NUMBER.split(other)
    # a unit of the last digit, as of 12.40 0.01, and a little for rounding
    return parts[::2] == others[::2] and all(
        abs(float(a) - float(b)) <= 1.01 * 10.0 ** -min(len(n.partition(".")[2]) for n in (a, b))
        for a, b in zip(parts[1::2], others[1::2], strict=True)
    )


def _held(claims: Sequence[Mapping[str, Any]], tables: Mapping[str, str]) -> str:
    """Return how many claims of each kind hold, and how near the tables are to print."""
    rows = [
        (f"{kind}: {KINDS[kind]}", f"{held} of {count}")
        for kind, (held, count) in holding(claims).items()
    ]
    table = pd.DataFrame(rows, columns=["A claim of the paper is", "Reproduced"])
    left_out = sum(claim["verdict"] == "not informative" for claim in claims)
    two, three, four = (
        pd.read_csv(Path(tables[f"table{number}_seeds"]).with_suffix(".csv"))
        for number in (2, 3, 4)
    )
    errors = pd.concat([two, three])
    off = 100.0 * (errors["mean"] / errors["published_mean"] - 1.0).abs()
    away = 100.0 * (four["rmse_deg"] / four["published_rmse_deg"] - 1.0).abs()
    most = away.groupby(four["controller"]).max()
    return (
        f"{table.to_markdown(index=False, disable_numparse=True)}\n\n"
        f"Left out: {left_out} that hold for almost any numbers. The {len(off)} means of Tables "
        f"II and III are {off.median():.1f} % off print in the median and {off.max():.0f} % at "
        f"most; those of Table IV up to {most['fprc']:.0f} % in open loop and "
        f"{most['fprc_pd']:.0f} % in closed loop."
    )


def _verdicts(judged: Mapping[str, Any]) -> str:
    """Return the claims as sentences, by kind, each with the number that decides its verdict."""
    parts = []
    for kind, what in KINDS.items():
        claims = [claim for claim in judged["claims"] if claim["rig"] == kind]
        if not claims:
            continue
        parts.append(f"### {kind.capitalize()}: {what}\n")
        for claim in claims:
            text, of = claim["claim"].replace("+-", "±"), claim["statements"]
            deciding = (found for found in of if found["verdict"] == claim["verdict"])
            found = next(deciding, of[0])
            mean, first, last = (f"{found[key]:.3g}" for key in ("mean", "first", "last"))
            interval = f" ({first} to {last})" if first != last else ""
            more = f" (one of {len(of)} numbers)" if len(of) > 1 else ""
            rigs = f"; holds on {claim['rigs']} rigs" if claim["rigs"] != "-" else ""
            parts.append(
                f"- **{claim['id']}, {claim['verdict']}.** {text[:1].upper()}{text[1:]}. "
                f"*{found['text']}: {mean}{interval}, limit {found['limits']}{more}{rigs}.*"
            )
        parts.append("")
    return "\n".join([*parts, judged["note"]])
