"""Put the numbers of the results into the README."""

import logging
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd

from fprc.artifacts import read_json, replacing, write_text
from fprc.errors import FprcError

log = logging.getLogger(__name__)


def update_readme(
    pages: Sequence[str], orders: str, ledger: str, figure: str, *, readme: str, picture: str
) -> None:
    """Replace the generated blocks of the README, named after the pages, and its picture."""
    blocks = {Path(page).stem: Path(page).read_text(encoding="utf-8") for page in pages}
    blocks["orders"] = _sentence(pd.read_csv(orders))
    blocks["verdicts"] = _verdicts(read_json(ledger)["claims"])
    text = Path(readme).read_text(encoding="utf-8")
    for name, block in blocks.items():
        text = replace_block(text, name, block)
    write_text(readme, text)
    with replacing(picture) as temporary:
        temporary.write_bytes(Path(figure).read_bytes())
    log.info("updated %s and %s", readme, picture)


def replace_block(text: str, name: str, block: str) -> str:
    """Return ``text`` with the lines between the markers of ``name`` replaced.

    Raises
    ------
    FprcError
        The markers are not there exactly once.
    """
    begin, end = f"<!-- {name}: generated -->", f"<!-- {name}: end -->"
    pattern = re.compile(f"{re.escape(begin)}.*?{re.escape(end)}", re.DOTALL)
    if not (text.count(begin) == text.count(end) == 1 == len(pattern.findall(text))):
        raise FprcError(f"README.md: needs the lines {begin} and {end} once each; put them back")
    return pattern.sub(lambda _: f"{begin}\n{block.strip()}\n{end}", text)


def _verdicts(claims: Sequence[Mapping[str, str]]) -> str:
    page = pd.DataFrame(claims)[["id", "claim", "verdict"]].rename(columns=str.capitalize)
    return page.to_markdown(index=False)


def _sentence(orders: pd.DataFrame) -> str:
    ratio = orders["esn_over_fprc_training"]
    held = {
        "FPRC has the lowest test RMSE": "fprc_lowest_test",
        "FPRC is below Fuzzy-linear in training, validation and test": "fprc_below_fuzzy_linear",
        "ESN and FPRC are within 30 % of each other in training": "training_within_30_percent",
        "with the logs reversed, FPRC has the lowest test RMSE": "fprc_lowest_reversed_test",
        "with the logs reversed, every test RMSE is worse": "reversed_tests_worse",
    }
    lines = [f"- {what}: on {orders[key].sum()} of {len(orders)}" for what, key in held.items()]
    span = f"{ratio.min():.2f} to {ratio.max():.2f}"
    lines.append(f"- the ESN's training RMSE over FPRC's: {span} (paper: 0.99)")
    return "\n".join(lines)
