"""Numbers of the results in the README and the pages of docs/: put there, and checked.

They stand in blocks between two markers.
"""

import logging
import re
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from fprc.artifacts import read_json, replacing, write_text
from fprc.claims.ledger import KINDS, changed_verdicts, holding
from fprc.errors import FprcError
from fprc.escape import typeset
from fprc.yaml_file import read_yaml

log = logging.getLogger(__name__)

_NUMBER = re.compile(r"(\d+(?:\.\d+)?)")


def update_pages(
    figures: Sequence[str], *, pages: Sequence[str], pictures: Sequence[str], **tables: str
) -> None:
    """Replace the generated blocks of pages, and their pictures; all of them or none.

    Parameters
    ----------
    figures, pictures : sequence of str
        Figures of the results, and their copies in docs.
    pages : sequence of str
        Each block is on the pages that have its marker, in README.md typeset.
    **tables : str
        Tables by their blocks, in Markdown; of claims, JSON.

    Raises
    ------
    FprcError
        A block is on no page, or its two markers are not there once each.
    """
    blocks = {
        name: Path(table).read_text(encoding="utf-8")
        for name, table in tables.items()
        if table.endswith(".md")
    }
    if "verdicts" in tables:
        judged = read_json(tables["verdicts"])
        blocks |= {"verdicts": _verdicts(judged), "held": _held(judged["claims"], tables)}
    texts = {path: with_blocks(path, blocks) for path in pages}
    for name, block in blocks.items():
        if not any(f"<!-- {name}: " in text for text in texts.values()):
            replace_block(texts[pages[-1]], name, block, pages[-1])  # which refuses it
    for path, text in texts.items():
        write_text(path, text)
    for figure, picture in zip(figures, pictures, strict=True):
        with replacing(picture) as temporary:
            temporary.write_bytes(Path(figure).read_bytes())


def check_results(ledger: str, verdicts: str, pages: Sequence[str] = ()) -> None:
    """Check verdicts and README.md.

    Parameters
    ----------
    ledger, verdicts : str
        Files of the judged claims and of the declared verdicts.
    pages : sequence of str
        Tables of the report; without them README.md is not checked.

    Raises
    ------
    FprcError
        Lists every verdict that differs from the declared one, and the first line of README.md
        with other numbers.
    """
    declared = {name: row["verdict"] for name, row in read_yaml(verdicts)["claims"].items()}
    claims = read_json(ledger)["claims"]
    tables = {Path(page).stem: Path(page).read_text(encoding="utf-8") for page in pages}
    failures = {
        f"verdicts differ from {verdicts}; if the new ones in {ledger} are right, declare them in "
        f"{verdicts}": changed_verdicts(claims, declared),
        "numbers differ from those that were built; `make docs` puts these there": [
            *(different_lines("README.md", tables) if tables else ())
        ],
    }
    problems = [
        "\n".join([f"{what}:", *(f"  {line}" for line in lines)])
        for what, lines in failures.items()
        if lines
    ]
    if problems:
        raise FprcError("\n".join(problems))
    log.info("all %d verdicts are as declared", len(declared))


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


def _same(one: str, other: str) -> bool:
    """Return whether two lines are the same but for the last digits of their numbers."""
    parts, others = _NUMBER.split(one), _NUMBER.split(other)
    if parts[::2] != others[::2]:
        return False
    numbers = [(Decimal(a), Decimal(b)) for a, b in zip(parts[1::2], others[1::2], strict=True)]
    # what a unit of the last digit is, as of 12.40 0.01
    return all(abs(a - b) <= max(_unit(a), _unit(b)) for a, b in numbers)


def _unit(number: Decimal) -> Decimal:
    return Decimal(1).scaleb(int(number.as_tuple().exponent))


def _held(claims: Sequence[Mapping[str, Any]], tables: Mapping[str, str]) -> str:
    """Return how many claims of each kind hold, and how near the tables are to print."""
    rows = [
        (f"{kind}: {KINDS[kind]}", f"{held} of {count}")
        for kind, (held, count) in holding(claims).items()
    ]
    left_out = sum(claim["verdict"] == "not informative" for claim in claims)
    table = pd.DataFrame(rows, columns=["A claim of the paper is", "Reproduced"])
    errors = pd.concat([_read(tables[name]) for name in ("table2_seeds", "table3_seeds")])
    off = 100.0 * np.abs(errors["mean"] / errors["published_mean"] - 1.0)
    tracking = _read(tables["table4_seeds"]).dropna(subset="published_rmse_deg")
    ratio = tracking["rmse_deg"] / tracking["published_rmse_deg"]
    most = (100.0 * np.abs(ratio - 1.0)).groupby(tracking["controller"]).max()
    return (
        f"{_as_text(table)}\n\n"
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
        parts += [f"### {kind.capitalize()}: {what}\n"] if claims else []
        for claim in claims:
            text = claim["claim"].replace("+-", "±")
            verdicts = [statement["verdict"] for statement in claim["statements"]]
            at = verdicts.index(claim["verdict"]) if claim["verdict"] in verdicts else 0
            found = claim["statements"][at]
            mean, first, last = (f"{found[key]:.3g}" for key in ("mean", "first", "last"))
            interval = f" ({first} to {last})" if first != last else ""
            more = f" (one of {len(verdicts)} numbers)" if len(verdicts) > 1 else ""
            rigs = f"; holds on {claim['rigs']} rigs" if claim["rigs"] != "-" else ""
            parts.append(
                f"- **{claim['id']}, {claim['verdict']}.** {text[:1].upper()}{text[1:]}. "
                f"*{found['text']}: {mean}{interval}, limit {found['limits']}{more}{rigs}.*"
            )
        parts += [""] if claims else []
    return "\n".join([*parts, judged["note"]])


def _read(page: str) -> pd.DataFrame:
    return pd.read_csv(Path(page).with_suffix(".csv"))


def _as_text(page: pd.DataFrame) -> str:
    return str(page.to_markdown(index=False, disable_numparse=True))
