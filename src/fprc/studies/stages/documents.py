"""Put the numbers of the results into the README and the pages of docs/."""

import logging
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from fprc.artifacts import read_json, replacing, write_text
from fprc.studies import blocks as of_pages
from fprc.studies.beyond import tables as beyond

log = logging.getLogger(__name__)


def update_readme(
    pages: Sequence[str],
    ledger: str,
    figures: Sequence[str],
    *,
    readme: str,
    results: str,
    pictures: Sequence[str],
) -> None:
    """Replace the generated blocks of the README and of docs/results.md, and the pictures.

    Parameters
    ----------
    pages : sequence of str
        Tables; a block is named after its page.
    ledger : str
        Claims, JSON.
    figures, pictures : sequence of str
        Figures of the results, and their copies in docs.
    readme, results : str
        The README, and docs/results.md.
    """
    blocks = {Path(path).stem: _read(path) for path in pages} | {
        "verdicts": _verdicts(read_json(ledger))
    }
    first = of_pages.readme_blocks(pages)
    texts = {path: _updated(path, new) for path, new in ((readme, first), (results, blocks))}
    for path, text in texts.items():
        write_text(path, text)
    _copy(figures, pictures)


def update_tables(
    pages: Sequence[str], figures: Sequence[str] = (), *, page: str, pictures: Sequence[str] = ()
) -> None:
    """Replace the generated blocks of a page that are tables, and its pictures.

    Parameters
    ----------
    pages : sequence of str
        Tables; a block is named after folder and file.
    figures, pictures : sequence of str
        Figures of the results, and their copies in docs.
    """
    _update(page, _tables(pages))
    _copy(figures, pictures)


def _copy(figures: Sequence[str], pictures: Sequence[str]) -> None:
    """Replace pictures of the documentation by figures of the results."""
    for figure, picture in zip(figures, pictures, strict=True):
        with replacing(picture) as temporary:
            temporary.write_bytes(Path(figure).read_bytes())


def update_beyond_page(
    verdicts: str,
    figures: Sequence[str],
    *,
    page: str,
    details: str,
    board: str,
    pictures: Sequence[str],
    world: str,
    **csv: str,
) -> None:
    """Replace the generated blocks of docs/beyond.md and its details, and the pictures.

    Parameters
    ----------
    page : str
        Page with the table of the claims.
    details : str
        Page with the other tables but the leaderboard.
    board : str
        Page with the leaderboard.
    figures, pictures : sequence of str
        Figures of the results, and their copies in docs.
    world : str
        World with the rig of the configuration.
    **csv : str
        Tables by name: ``models``, ``tracking``, ``offsets``, ``capacities``, ``lengths``.
    """
    found = {name: pd.read_csv(path) for name, path in csv.items()}
    judged = read_json(verdicts)
    blocks = beyond.blocks(judged, found, world)
    _update(board, {"leaderboard": blocks.pop("leaderboard")})
    _update(page, {"beyond_claims": blocks.pop("beyond_claims")})
    _update(details, blocks)
    _copy(figures, pictures)


def _tables(pages: Sequence[str]) -> dict[str, str]:
    return {f"{Path(path).parent.name}_{Path(path).stem}": _read(path) for path in pages}


def _read(path: str) -> str:
    return Path(path).read_text(encoding="utf-8")


def _markdown(table: pd.DataFrame) -> str:
    return table.to_markdown(index=False, disable_numparse=True)


def _updated(path: str, blocks: Mapping[str, str]) -> str:
    text = _read(path)
    for name, block in blocks.items():
        text = of_pages.replace_block(text, name, block, path)
    return text


def _update(path: str, blocks: Mapping[str, str]) -> None:
    write_text(path, _updated(path, blocks))
    log.info("updated %s", path)


def _verdicts(judged: Mapping[str, Any]) -> str:
    """Return a table of the claims."""
    rows = [
        {
            "Id": claim["id"],
            "Claim": claim["claim"],
            "Verdict": claim["verdict"],
            "Fitted?": claim["rig"],
            "Ours, 95 % interval": claim["ours"],
        }
        for claim in judged["claims"]
    ]
    return f"{_markdown(pd.DataFrame(rows))}\n\n{judged['note']}"
