"""Check verdicts, the files of the results folder, the documentation's pictures, the README."""

import logging
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import reduce
from pathlib import Path

from PIL import Image, ImageChops

from fprc.artifacts import leftovers, read_json
from fprc.claims.ledger import changed_verdicts
from fprc.errors import FprcError
from fprc.provenance import changed_results
from fprc.studies.blocks import different_blocks, readme_blocks
from fprc.yaml_file import read_yaml

log = logging.getLogger(__name__)

#: A picture is outdated if more than _PIXELS pixels differ by more than _LEVELS of 255. On another
#: processor a few edges differ by one level; a dot moved by half a pixel changes 40 pixels by more
#: than 16 levels, and a different digit 110. See docs/decisions/0022.
_LEVELS = 16
_PIXELS = 20


def check_results(
    ledger: str,
    verdicts: str,
    pages: Sequence[str] = (),
    *,
    folders: Mapping[str, str],
    made: Sequence[str],
    pictures: Mapping[str, str],
) -> None:
    """Check verdicts, results, files and pictures.

    A verdict on execution times that differs from the declared one is only a
    warning, since times differ between runs and machines.

    Parameters
    ----------
    ledger, verdicts : str
        Files of the judged claims and of the declared verdicts.
    pages : sequence of str
        Tables of the report; without them README.md is not checked.
    folders : Mapping
        Folders ``results`` and ``raw``; files in ``raw`` are not checked.
    made : sequence of str
        Regular expressions of the files that the rules make.
    pictures : Mapping
        Pictures of the documentation, each with the figure that it is a copy of.

    Raises
    ------
    FprcError
        Lists every verdict that differs from the declared one, every result that was changed
        after its rule wrote it, every file in the results folder that no rule makes, every
        picture that differs from its figure, and every block of README.md with other numbers.
    """
    declared = read_yaml(verdicts)
    claims = read_json(ledger)["claims"]
    timed = {row["id"] for row in claims if row["rig"] == "timed"} & declared.keys()
    changed = changed_verdicts(claims, declared)
    of_times = [line for line in changed if line.split(":")[0] in timed]
    for line in of_times:
        log.warning("%s; not an error, since execution times differ between runs", line)
    failures = {
        f"verdicts differ from {verdicts}; if the new ones in {ledger} are right, declare them in "
        f"{verdicts}": [line for line in changed if line not in of_times],
        "results that were damaged or edited after their rules wrote them; make each again with "
        "`snakemake --cores 2 --forcerun FILE -- FILE`": changed_results(folders["results"]),
        "files that no rule makes; remove them, or move them elsewhere": [
            *unknown_files(folders["results"], folders["raw"], made),
            *unknown_pictures(pictures),
        ],
        "pictures differ from the figures that were built; copy the figures with `make docs`": [
            f"{picture} differs from {figure}" for picture, figure in outdated(pictures)
        ],
        "numbers differ from those that were built; `make docs` puts these there": [
            *(different_blocks("README.md", readme_blocks(pages)) if pages else ())
        ],
    }
    problems = [
        "\n".join([f"{what}:", *(f"  {line}" for line in lines)])
        for what, lines in failures.items()
        if lines
    ]
    if problems:
        raise FprcError("\n".join(problems))
    as_declared = len(declared) - len(of_times)
    log.info(
        "%d of %d verdicts are as declared; a rule makes every file", as_declared, len(declared)
    )


def unknown_files(results: str, raw: str, made: Sequence[str]) -> Iterator[str]:
    """Yield the files of a results folder that no rule makes.

    Exempt are the raw logs, the digests, README.md, hidden files other than those of a killed
    process, and folders of other results, which have a folder ``logs`` or a
    ``report.md`` of `fprc readout`.
    """
    patterns = [re.compile(pattern) for pattern in made]
    todo = [Path(results)]
    while todo:
        folder = todo.pop()
        yield from map(str, leftovers(folder))
        for path in sorted(folder.iterdir()):
            if path.is_dir():
                other = (path / "logs").is_dir() or (path / "report.md").exists()
                if path not in (Path(raw), Path(results, "digests")) and not other:
                    todo.append(path)
            elif not (
                path.name.startswith(".")
                or path == Path(results, "README.md")
                or any(pattern.fullmatch(str(path)) for pattern in patterns)
            ):
                yield str(path)


def unknown_pictures(pictures: Mapping[str, str]) -> Iterator[str]:
    """Yield the files in the documentation's picture folders that no rule puts there."""
    for folder in sorted({Path(picture).parent for picture in pictures}):
        yield from (str(p) for p in sorted(folder.iterdir()) if str(p) not in pictures)


def outdated(pictures: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield each picture that differs from its figure, with the figure, if the figure was built."""
    for picture, figure in pictures.items():
        if Path(figure).exists() and pixels_apart(picture, figure) > _PIXELS:
            yield picture, figure


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
