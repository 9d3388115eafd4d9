"""Put the numbers of the results into the README and the pages of docs/."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from fprc.artifacts import read_json, replacing, write_text
from fprc.studies.blocks import replace_block, with_blocks


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
        name: _verdicts(read_json(table))
        if table.endswith(".json")
        else Path(table).read_text(encoding="utf-8")
        for name, table in tables.items()
    }
    texts = {path: with_blocks(path, blocks) for path in pages}
    for name, block in blocks.items():
        if not any(f"<!-- {name}: " in text for text in texts.values()):
            replace_block(texts[pages[-1]], name, block, pages[-1])  # which refuses it
    for path, text in texts.items():
        write_text(path, text)
    for figure, picture in zip(figures, pictures, strict=True):
        with replacing(picture) as temporary:
            temporary.write_bytes(Path(figure).read_bytes())


def _verdicts(judged: Mapping[str, Any]) -> str:
    """Return a table of the claims."""
    columns = {
        "id": "Id",
        "claim": "Claim",
        "verdict": "Verdict",
        "rig": "Fitted?",
        "ours": "Ours, 95 % interval",
        "limits": "Limits",
        "note": "Note",
    }
    claims = pd.DataFrame(judged["claims"])
    claims["limits"] = [
        "; ".join(dict.fromkeys(statement["limits"] for statement in statements))
        for statements in claims["statements"]
    ]
    page = claims[list(columns)].rename(columns=columns)
    table = page.to_markdown(index=False, disable_numparse=True)
    return f"{table}\n\n{judged['note']}"
