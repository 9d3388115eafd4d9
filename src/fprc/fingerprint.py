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


def _named(names: str) -> tuple[str, ...]:
    return tuple(f"fprc.{name}" for name in names.split())


#: Beginnings of the names of what makes tables, figures, claims and pages of results.
SHOWS = _named(
    "claims escape figures provenance stages.draw stages.report stages.tabulate studies.beyond "
    "studies.online studies.pages studies.verdicts tables"
)
#: Those of what no rule of the paper runs, or what only passes on files and settings.
ELSEWHERE = _named(
    "__init__ __main__ apparatus cli commands config datasets errors fingerprint given plan "
    "recordings studies"
)


def code_that_computes(
    *models: str, settings: Mapping[str, Any] | None = None, also: tuple[str, ...] = ()
) -> str:
    """Return a digest of the code that computes, with these models and not with others.

    Of a model from outside, which ``settings``, the section ``models``, names, the file of its
    class counts. ``also`` are beginnings of the names of further modules, as ``fprc.studies``.
    """
    own = {class_module(name) for name in COMPETITORS}
    shared = {
        name
        for name in modules()
        if not name.startswith(SHOWS) and (name.startswith(also) or not name.startswith(ELSEWHERE))
    }
    return _digest(shared - own | {class_module(name, settings) for name in models})


def code_that_shows() -> str:
    """Return a digest of the code and the other files of what is shown."""
    folder = Path(fprc.__path__[0])
    patterns = ("config/published.yaml", "claims/*.*", "figures/drawings/*", "stages/*.*")
    files = sorted(path for pattern in patterns for path in folder.glob(pattern))
    data = (path.read_bytes() for path in files if path.suffix != ".py")
    code = _digest(name for name in modules() if name.startswith(SHOWS))
    return hashlib.sha256(b"".join([code.encode(), *data])).hexdigest()[:16]


def modules() -> dict[str, Path]:
    """Return the files of this package by their modules."""
    folder = Path(fprc.__path__[0])
    found = {path: path.relative_to(folder).with_suffix("").parts for path in folder.rglob("*.py")}
    return {".".join(("fprc", *parts)): path for path, parts in found.items()}


def _digest(names: Iterable[str]) -> str:
    ours = modules()
    files = {name: ours.get(name) or Path(sys.modules[name].__file__ or "") for name in names}
    lines = (f"{name} {_code_of(path.read_bytes())}" for name, path in sorted(files.items()))
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16]


@cache
def _code_of(source: bytes) -> str:
    """Return code without docstrings and comments."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        match getattr(node, "body", None):
            case [ast.Expr(ast.Constant(str())), *_] as body:
                body.pop(0)
    return ast.dump(tree)
