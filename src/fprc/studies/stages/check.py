"""Check verdicts, the documentation's pictures and the README."""

import logging
import math
from collections.abc import Mapping, Sequence
from functools import reduce
from pathlib import Path

from PIL import Image, ImageChops

from fprc.artifacts import read_json
from fprc.claims.ledger import changed_verdicts
from fprc.errors import FprcError
from fprc.studies.blocks import different_lines
from fprc.yaml_file import read_yaml

log = logging.getLogger(__name__)

#: A picture is outdated if more than _PIXELS pixels differ by more than _LEVELS of 255. On another
#: processor a few edges differ by one level; a dot moved by half a pixel changes 40 pixels by more
#: than 16 levels, and a different digit 110. See docs/decisions.md.
_LEVELS = 16
_PIXELS = 20


def check_results(
    ledger: str,
    verdicts: str,
    pages: Sequence[str] = (),
    *,
    pictures: Mapping[str, str],
) -> None:
    """Check verdicts, pictures and README.md.

    Parameters
    ----------
    ledger, verdicts : str
        Files of the judged claims and of the declared verdicts.
    pages : sequence of str
        Tables of the report; without them README.md is not checked.
    pictures : Mapping
        Pictures of the documentation, each with the figure that it is a copy of; those whose figure
        was not built are not checked.

    Raises
    ------
    FprcError
        Lists every verdict that differs from the declared one, every picture that differs from
        its figure, and every block of README.md with other numbers.
    """
    declared = read_yaml(verdicts)["verdicts"]
    claims = read_json(ledger)["claims"]
    tables = {Path(page).stem: Path(page).read_text(encoding="utf-8") for page in pages}
    failures = {
        f"verdicts differ from {verdicts}; if the new ones in {ledger} are right, declare them in "
        f"{verdicts}": changed_verdicts(claims, declared),
        "pictures differ from the figures that were built; copy the figures with `make docs`": [
            f"{picture} differs from {figure}"
            for picture, figure in pictures.items()
            if Path(figure).exists() and pixels_apart(picture, figure) > _PIXELS
        ],
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


def pixels_apart(one: Path | str, other: Path | str) -> float:
    """Return how many pixels differ visibly; infinity if two pictures cannot be compared."""
    try:
        with Image.open(one) as first, Image.open(other) as second:
            if first.size != second.size:
                return math.inf
            bands = ImageChops.difference(first.convert("RGBA"), second.convert("RGBA")).split()
    except OSError:
        return math.inf
    return sum(reduce(ImageChops.lighter, bands).histogram()[_LEVELS + 1 :])
