"""Put the numbers of the results into the README."""

import logging
import re
from pathlib import Path

import pandas as pd

from fprc.artifacts import replacing, write_text
from fprc.errors import FprcError

log = logging.getLogger(__name__)


def update_readme(
    errors: str,
    seeds: str,
    orders: str,
    timing: str,
    figure: str,
    *,
    readme: str,
    picture: str,
) -> None:
    """Replace the generated blocks of the README and its picture."""
    blocks = {
        "table2": Path(errors).read_text(encoding="utf-8"),
        "table2_seeds": Path(seeds).read_text(encoding="utf-8"),
        "table2_orders": _sentence(pd.read_csv(orders)),
        "table2_timing": Path(timing).read_text(encoding="utf-8"),
    }
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


def _sentence(orders: pd.DataFrame) -> str:
    seeds = len(orders)
    ratio = orders["esn_over_fprc_training"]
    return (
        f"Seed by seed: FPRC has the lowest test RMSE on {orders['fprc_lowest_test'].sum()} of "
        f"{seeds}; it is below Fuzzy-linear in training, validation and test on "
        f"{orders['fprc_below_fuzzy_linear'].sum()} of {seeds}; the ESN's training RMSE over "
        f"FPRC's lies between {ratio.min():.2f} and {ratio.max():.2f} (paper: 0.99)."
    )
