"""Put the numbers of the results into the README and the pages of docs/."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from fprc.artifacts import read_json, replacing, write_text
from fprc.claims.ledger import KINDS, holding
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
        f"{table.to_markdown(index=False, disable_numparse=True)}\n\n"
        f"Left out: {left_out} that hold for almost any numbers. The {len(off)} means of Tables "
        f"II and III are {off.median():.1f} % off print in the median and {off.max():.0f} % at "
        f"most; those of Table IV up to {most['fprc']:.0f} % in open loop and "
        f"{most['fprc_pd']:.0f} % in closed loop."
    )


def _read(page: str) -> pd.DataFrame:
    return pd.read_csv(Path(page).with_suffix(".csv"))


def _verdicts(judged: Mapping[str, Any]) -> str:
    """Return a table of the claims."""
    columns = {
        "id": "Id",
        "claim": "Claim",
        "verdict": "Verdict",
        "rig": "Fitted?",
        "rigs": "Rigs",
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
