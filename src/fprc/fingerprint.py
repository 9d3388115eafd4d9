"""Digests of this package's code: the workflow runs a rule again when its code has changed.

Snakemake does not look into an installed package. Each rule therefore has a digest among its
params, of the code that computes or of that which shows; comments and docstrings do not count.
"""

import ast
import hashlib
import sys
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import fprc
from fprc.registry import COMPETITORS, class_module

#: Beginnings of the names of what makes tables, figures, claims and pages of results.
SHOWS = (
    "claims", "escape", "figures", "provenance", "stages.draw",
    "stages.report", "stages.tabulate", "studies.beyond", "studies.online", "studies.pages",
    "studies.verdicts", "tables",
)  # fmt: skip
#: Those of what no rule of the paper runs, or what only passes on files and settings.
ELSEWHERE = (
    "__init__", "__main__", "apparatus", "cli", "commands", "config", "datasets", "errors",
    "fingerprint", "given", "plan", "recordings", "studies", "yaml_file",
)  # fmt: skip


def code_that_computes(
    *models: str, settings: Mapping[str, Any] | None = None, also: Iterable[str] = ()
) -> str:
    """Return a digest of the code that computes.

    Parameters
    ----------
    *models : str
        Models that run. The module of each other model's class does not count.
    settings : Mapping, optional
        Section ``models`` of the configuration. Of a model from outside the file of its class
        counts.
    also : iterable of str
        Further packages and modules, as ``studies.family``.
    """
    computing = {name for name in modules() if not name.startswith(SHOWS)}
    own = {class_module(name).removeprefix("fprc.") for name in COMPETITORS}
    shared = {name for name in computing if not name.startswith(ELSEWHERE)} - own
    further = {name for name in computing if name.startswith(tuple(also))}
    return _digest([*shared, *further, *(class_module(name, settings) for name in models)])


def code_that_shows() -> str:
    """Return a digest of the code and the other files of what is shown."""
    folder = Path(fprc.__path__[0])
    files = [
        folder / "config/published.yaml",
        *folder.glob("claims/*.*"),
        *folder.glob("figures/drawings/*"),
        *folder.glob("stages/*.*"),
    ]
    data = (path.read_bytes() for path in sorted(files) if path.suffix != ".py")
    code = _digest(name for name in modules() if name.startswith(SHOWS))
    return hashlib.sha256(b"".join([code.encode(), *data])).hexdigest()[:16]


@cache
def modules() -> dict[str, Path]:
    """Return the files of this package by their modules, without ``fprc.``."""
    folder = Path(fprc.__path__[0])
    return {
        ".".join(path.relative_to(folder).with_suffix("").parts): path
        for path in sorted(folder.rglob("*.py"))
    }


def _digest(names: Iterable[str]) -> str:
    lines = sorted({f"{name} {_code_of(name.removeprefix('fprc.'))}" for name in names})
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16]


@cache
def _code_of(name: str) -> str:
    """Return a hash of the code of a module of this package or of an imported one."""
    path = modules().get(name) or Path(sys.modules[name].__file__ or "")
    tree = ast.parse(path.read_bytes())
    for node in ast.walk(tree):
        match getattr(node, "body", None):
            case [ast.Expr(ast.Constant(str())), *_] as body:
                body.pop(0)
    return hashlib.sha256(ast.dump(tree).encode()).hexdigest()
