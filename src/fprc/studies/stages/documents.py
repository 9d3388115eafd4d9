"""Put the numbers of the results into the README and the pages of docs/."""

import logging
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from fprc.artifacts import read_json, replacing, write_text
from fprc.competitors import TITLES
from fprc.errors import FprcError
from fprc.paper import ERRORS
from fprc.registry import title_of
from fprc.studies.beyond import tables as beyond
from fprc.tables.models import deviations

log = logging.getLogger(__name__)


def update_readme(
    pages: Sequence[str],
    orders: str,
    seeds: Sequence[str],
    ledger: str,
    figure: str,
    *,
    readme: str,
    results: str,
    picture: str,
) -> None:
    """Replace the generated blocks of the README and of docs/results.md, and the picture.

    Parameters
    ----------
    pages : sequence of str
        Tables; a block is named after its page.
    orders : str
        Order of the models on each further seed, CSV.
    seeds : sequence of str
        Tables II to IV over further seeds, CSV.
    ledger : str
        Claims, JSON.
    figure, picture : str
        Figure of the results, and its copy in docs.
    readme, results : str
        The README, and docs/results.md.
    """
    judged = read_json(ledger)
    blocks = {Path(path).stem: _read(path) for path in pages} | {
        "orders": _orders(pd.read_csv(orders)),
        "deviations": _deviations(seeds[:2]),
        "verdicts": _verdicts(judged),
    }
    first = {name: blocks[name] for name in ("table2_seeds", "table4_seeds")}
    first["outcome"] = f"{_outcome(judged)} {blocks['deviations']} {_tracking(seeds[2])}"
    texts = {path: _updated(path, new) for path, new in ((readme, first), (results, blocks))}
    for path, text in texts.items():
        write_text(path, text)
    update_picture(figure, picture=picture)


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
    for figure, copy in zip(figures, pictures, strict=True):
        update_picture(figure, picture=copy)


def update_picture(figure: str, *, picture: str) -> None:
    """Replace a picture of the documentation by a figure of the results."""
    with replacing(picture) as temporary:
        temporary.write_bytes(Path(figure).read_bytes())


def update_beyond_page(
    verdicts: str,
    figures: Sequence[str],
    *,
    readme: str,
    page: str,
    board: str,
    pictures: Sequence[str],
    world: str,
    **csv: str,
) -> None:
    """Replace the generated blocks of docs/beyond.md, the leaderboard, and the pictures.

    The README gets the verdicts on what the reservoir is worth.

    Parameters
    ----------
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
    blocks = beyond.blocks(judged, found, world, TITLES)
    _update(readme, {"worth": blocks.pop("worth")})
    _update(board, {"leaderboard": blocks.pop("leaderboard")})
    _update(page, blocks)
    for figure, picture in zip(figures, pictures, strict=True):
        update_picture(figure, picture=picture)


def _tables(pages: Sequence[str]) -> dict[str, str]:
    return {f"{Path(path).parent.name}_{Path(path).stem}": _read(path) for path in pages}


def _read(path: str) -> str:
    return Path(path).read_text(encoding="utf-8")


def _markdown(table: pd.DataFrame) -> str:
    return table.to_markdown(index=False, disable_numparse=True)


def _updated(path: str, blocks: Mapping[str, str]) -> str:
    text = _read(path)
    for name, block in blocks.items():
        text = replace_block(text, name, block, path)
    return text


def _update(path: str, blocks: Mapping[str, str]) -> None:
    write_text(path, _updated(path, blocks))
    log.info("updated %s", path)


def replace_block(text: str, name: str, block: str, path: str = "README.md") -> str:
    """Return ``text`` with the lines between the markers of ``name`` replaced.

    Raises
    ------
    FprcError
        The two markers do not occur exactly once each.
    """
    begin, end = f"<!-- {name}: generated -->", f"<!-- {name}: end -->"
    pattern = re.compile(f"{re.escape(begin)}.*?{re.escape(end)}", re.DOTALL)
    if not (text.count(begin) == text.count(end) == 1 == len(pattern.findall(text))):
        raise FprcError(f"{path}: needs the lines {begin} and {end} once each; put them back")
    return pattern.sub(lambda _: f"{begin}\n{block.strip()}\n{end}", text)


def _outcome(judged: Mapping[str, Any]) -> str:
    """Return sentences on how many claims hold: first those that the rig was not fitted to."""
    claims = pd.DataFrame(judged["claims"])
    kind = claims["rig"].replace("half fitted", "fitted")
    predicted, fitted, assumed, timed = (
        claims[kind == name] for name in ("predicted", "fitted", "assumed", "timed")
    )
    sentences = [
        "**Of the paper's claims that the simulated rig was not fitted to, "
        f"{_held(predicted)} hold**{_others(predicted)}."
    ]
    if len(fitted):
        sentences.append(
            f"Of those that it was fitted to, at least in part, {_held(fitted)} hold"
            f"{_others(fitted)}."
        )
    if len(assumed):
        sentences.append(f"Of those built into the rig, {_held(assumed)} hold{_others(assumed)}.")
    if len(timed):
        sentences.append(
            f"Not counted, because they are about execution times: {', '.join(timed['id'])}."
        )
    return " ".join(sentences)


def _held(claims: pd.DataFrame) -> str:
    return f"{(claims['verdict'] == 'reproduced').sum()} of {len(claims)}"


def _others(claims: pd.DataFrame) -> str:
    """Return the claims that do not hold and those that are undecided, in brackets."""
    parts = []
    for verdict, words in (("not reproduced", "not"), ("undecided", "undecided")):
        ids = claims.loc[claims["verdict"] == verdict, "id"]
        if len(ids):
            parts.append(f"{words}: {', '.join(ids)}")
    return f" ({'; '.join(parts)})" if parts else ""


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


def _orders(orders: pd.DataFrame) -> str:
    """Return a list of the orders of Tables II and III, and on how many seeds each holds."""
    ratio = orders["esn_over_fprc_training"]
    columns = {
        "FPRC has the lowest test RMSE": "fprc_lowest_test",
        "FPRC is below Fuzzy-linear in training, validation and test": "fprc_below_fuzzy_linear",
        "ESN and FPRC are within 30 % of each other in training": "training_within_30_percent",
        "with the logs reversed, FPRC has the lowest test RMSE": "fprc_lowest_reversed_test",
        "with the logs reversed, every test RMSE is worse": "reversed_tests_worse",
    }
    lines = [f"- {what}: on {orders[key].sum()} of {len(orders)}" for what, key in columns.items()]
    span = f"{ratio.min():.2f} to {ratio.max():.2f}"
    lines.append(f"- the ESN's training RMSE over FPRC's: {span} (paper: 0.99)")
    return "\n".join(lines)


def _deviations(seeds: Sequence[str]) -> str:
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
        f"{100 * closed_loop:.0f} % in closed loop."
    )
