"""Draw the layers in CONTRIBUTING.md from the imports of src/fprc: `make layers`.

The layers are those of the contract LAYERS in pyproject.toml. An arrow means "imports"; it
is omitted if other arrows lead to the same place. Single modules at the bottom, which import no
package, have no arrows.
"""

import re
import sys
import tomllib
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path

import grimp

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "CONTRIBUTING.md"
BEGIN, END = "<!-- layers: generated -->\n", "<!-- layers: end -->"
PACKAGE = "fprc"
LAYERS = "One direction"


def imported() -> dict[str, set[str]]:
    """Return what each package or module of the top floor imports, but for types alone."""
    graph = grimp.build_graph(PACKAGE, exclude_type_checking_imports=True, cache_dir=None)
    rooms = {name.removeprefix(f"{PACKAGE}.") for name in graph.find_children(PACKAGE)}
    found: dict[str, set[str]] = {room: set() for room in rooms}
    for module in graph.modules - {PACKAGE}:
        for other in graph.find_modules_directly_imported_by(module) - {PACKAGE}:
            found[module.split(".")[1]].add(other.split(".")[1])
    return {room: others - {room} for room, others in found.items()}


def reduced(arrows: Mapping[str, set[str]]) -> dict[str, set[str]]:
    """Leave out each arrow to where others lead too; there is no circle."""

    def reach(room: str) -> set[str]:
        return arrows[room].union(*map(reach, arrows[room]))

    return {room: to.difference(*map(reach, to)) for room, to in arrows.items()}


def layers() -> list[list[str]]:
    """Return the layers of the contract, highest first."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    (layered,) = (each["layers"] for each in contracts if each["name"] == LAYERS)
    return [layer.split(" | ") for layer in layered]


def block() -> str:
    """Return the picture as a mermaid diagram in Markdown."""
    arrows = reduced(imported())
    packages = {room for room in arrows if (ROOT / f"src/{PACKAGE}/{room}").is_dir()}
    rows = [_row(layer, packages) for layer in layers()]
    lines = ["```mermaid", "flowchart TB"]
    lines += [f'  {node}["{text}"]' for row in rows for node, text in row.items() if node != text]
    # each row below the one before, by lines that are not seen
    lines += [f"  {' & '.join(above)} ~~~ {' & '.join(below)}" for above, below in pairwise(rows)]
    for row in rows:
        for room in row:
            shown = sorted(arrows[room] & packages)
            lines += [f"  {room} --> {' & '.join(shown)}"] if shown else []
    return "\n".join([*lines, "```", ""])


def _row(layer: list[str], packages: set[str]) -> dict[str, str]:
    """Return the nodes of a layer and their labels: its packages, and its modules as one."""
    row = {room: room for room in layer if room in packages}
    modules = [room for room in layer if room not in packages]
    return row | ({modules[0]: ", ".join(f"{room}.py" for room in modules)} if modules else {})


def updated(page: str) -> str:
    """Return the page with the picture that the imports give."""
    found, count = re.subn(
        f"{BEGIN}.*?{END}", lambda _: f"{BEGIN}{block()}{END}", page, flags=re.DOTALL
    )
    if count != 1:
        sys.exit(f"{PAGE.name} must have one block {BEGIN.strip()} ... {END}; it has {count}")
    return found


if __name__ == "__main__":
    PAGE.write_text(updated(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
