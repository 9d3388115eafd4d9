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
    """Return what each package or module of the top level imports, except for types only."""
    graph = grimp.build_graph(PACKAGE, exclude_type_checking_imports=True, cache_dir=None)
    names = {name.removeprefix(f"{PACKAGE}.") for name in graph.find_children(PACKAGE)}
    found: dict[str, set[str]] = {name: set() for name in names}
    for module in graph.modules - {PACKAGE}:
        for other in graph.find_modules_directly_imported_by(module) - {PACKAGE}:
            found[module.split(".")[1]].add(other.split(".")[1])
    return {name: others - {name} for name, others in found.items()}


def reduced(arrows: Mapping[str, set[str]]) -> dict[str, set[str]]:
    """Leave out every arrow whose end other arrows reach too; the graph has no cycles."""

    def reach(name: str) -> set[str]:
        return arrows[name].union(*map(reach, arrows[name]))

    return {name: to.difference(*map(reach, to)) for name, to in arrows.items()}


def layers() -> list[list[str]]:
    """Return the layers of the contract, highest first."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    (layered,) = (contract["layers"] for contract in contracts if contract["name"] == LAYERS)
    return [layer.split(" | ") for layer in layered]


def block() -> str:
    """Return the picture as a mermaid diagram in Markdown."""
    arrows = reduced(imported())
    packages = {name for name in arrows if (ROOT / f"src/{PACKAGE}/{name}").is_dir()}
    rows = [_row(layer, packages) for layer in layers()]
    lines = ["```mermaid", "flowchart TB"]
    lines += [f'  {node}["{text}"]' for row in rows for node, text in row.items() if node != text]
    # invisible links keep each row below the one before
    lines += [f"  {' & '.join(above)} ~~~ {' & '.join(below)}" for above, below in pairwise(rows)]
    for row in rows:
        for name in row:
            shown = sorted(arrows[name] & packages)
            lines += [f"  {name} --> {' & '.join(shown)}"] if shown else []
    return "\n".join([*lines, "```", ""])


def _row(layer: list[str], packages: set[str]) -> dict[str, str]:
    """Return the nodes of a layer and their labels: its packages, and its modules as one."""
    row = {name: name for name in layer if name in packages}
    modules = [name for name in layer if name not in packages]
    return row | ({modules[0]: ", ".join(f"{name}.py" for name in modules)} if modules else {})


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
