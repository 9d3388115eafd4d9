"""Put the numbers of the results into the README and the pages of docs/."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from fprc.artifacts import read_json, replacing, write_text
from fprc.studies import blocks as of_pages


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
    tables: Sequence[str],
    figures: Sequence[str] = (),
    *,
    pages: Sequence[str],
    pictures: Sequence[str] = (),
) -> None:
    """Replace the generated blocks of pages that are tables, and their pictures.

    Parameters
    ----------
    tables : sequence of str
        Tables; a block is named after folder and file.
    figures, pictures : sequence of str
        Figures of the results, and their copies in docs.
    pages : sequence of str
        Each block is on the first page that has its marker; the last page has all others.
    """
    blocks = {f"{Path(path).parent.name}_{Path(path).stem}": _read(path) for path in tables}
    for path in pages:
        text = _read(path)
        on_page = [name for name in blocks if f"<!-- {name}: " in text or path == pages[-1]]
        write_text(path, _updated(path, {name: blocks.pop(name) for name in on_page}))
    _copy(figures, pictures)


def _copy(figures: Sequence[str], pictures: Sequence[str]) -> None:
    """Replace pictures of the documentation by figures of the results."""
    for figure, picture in zip(figures, pictures, strict=True):
        with replacing(picture) as temporary:
            temporary.write_bytes(Path(figure).read_bytes())


def _read(path: str) -> str:
    return Path(path).read_text(encoding="utf-8")


def _updated(path: str, blocks: Mapping[str, str]) -> str:
    text = _read(path)
    for name, block in blocks.items():
        text = of_pages.replace_block(text, name, block, path)
    return text


def _verdicts(judged: Mapping[str, Any]) -> str:
    """Return a table of the claims."""
    columns = {
        "id": "Id",
        "claim": "Claim",
        "verdict": "Verdict",
        "rig": "Fitted?",
        "ours": "Ours, 95 % interval",
        "note": "Note",
    }
    page = pd.DataFrame(judged["claims"])[list(columns)].rename(columns=columns)
    table = page.to_markdown(index=False, disable_numparse=True)
    return f"{table}\n\n{judged['note']}"
