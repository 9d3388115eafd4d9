"""Fingerprint of the code that a rule runs, so that the workflow reruns what changed.

Snakemake cannot see into an installed package: an edit under src/ would leave stale results
behind. Each rule therefore has among its params the hash of its stage's module and of all that
this imports, without comments and docstrings.
"""

import ast
import hashlib
import inspect
import json
import os
import sys
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import fprc


class Source(NamedTuple):
    """A module: hash of its code, and what it imports as (module, name or None)."""

    code: str
    imports: list[tuple[str, str | None]]


def fingerprint(*modules: str) -> str:
    """Hash the code of modules of this package and of every one that they import.

    ``from package import name`` counts the module that defines the name, not all that the
    package imports. A module from outside this package counts by its own file alone.
    """
    found = {f"{module} {_source(module).code}" for module in _closure(modules)}
    _keep()
    return hashlib.sha256("\n".join(sorted(found)).encode()).hexdigest()[:16]


def _closure(modules: tuple[str, ...]) -> set[str]:
    seen: set[str] = set()
    todo = list(modules)
    while todo:
        module = todo.pop()
        if module not in seen:
            seen.add(module)
            todo += [_defining(*each) for each in _source(module).imports if _path(each[0])]
    return seen


def _defining(module: str, name: str | None) -> str:
    """Return the module that defines a name: a module itself, or where its package has it from."""
    if name is None:
        return module
    if _path(f"{module}.{name}"):
        return f"{module}.{name}"
    path = _path(module)
    if path and path.name == "__init__.py":
        for origin, imported in _source(module).imports:
            if imported == name and _path(origin):
                return _defining(origin, name)
    return module


@cache
def _path(module: str) -> Path | None:
    """Return the file of a module of this package, or None."""
    package, *rest = module.split(".")
    path = Path(fprc.__path__[0]).joinpath(*rest)
    files = (path / "__init__.py", path.with_suffix(".py")) if package == "fprc" else ()
    return next((file for file in files if file.is_file()), None)


@cache
def _source(module: str) -> Source:
    path = _path(module) or Path(inspect.getfile(sys.modules[module]))
    content = path.read_bytes()
    key = f"{module} {hashlib.sha256(content).hexdigest()}"
    if key not in _kept():
        tree = ast.parse(content)
        imports = sorted({(m, n or "") for m, n in _imports(tree)})
        for node in ast.walk(tree):
            body = getattr(node, "body", None)
            if isinstance(body, list) and body and _is_text(body[0]):
                body.pop(0)
        _kept()[key] = [hashlib.sha256(ast.dump(tree).encode()).hexdigest(), imports]
        _fresh.append(key)
    code, imports = _kept()[key]
    return Source(code, [(origin, name or None) for origin, name in imports])


def _imports(tree: ast.AST) -> Iterator[tuple[str, str | None]]:
    """Yield what a module imports, wherever in it, but for what only the types need."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, None) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from ((node.module or "", alias.name) for alias in node.names)
        elif not (isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"):
            yield from _imports(node)


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(getattr(node.value, "value", None), str)


_fresh: list[str] = []


@cache
def _kept() -> dict[str, Any]:
    """Return what was read before by other processes: each job asks again."""
    with suppress(OSError, ValueError):
        kept = json.loads(_file().read_text(encoding="utf-8"))
        return kept if isinstance(kept, dict) else {}
    return {}


def _keep() -> None:
    if _fresh:
        _fresh.clear()
        temporary = _file().with_suffix(f".{os.getpid()}")
        with suppress(OSError):  # a folder that cannot be written to is no error
            temporary.parent.mkdir(exist_ok=True)
            temporary.write_text(json.dumps(_kept()), encoding="utf-8")
            temporary.replace(_file())


def _file() -> Path:
    version = hashlib.sha256(Path(__file__).read_bytes() + sys.version.encode()).hexdigest()[:16]
    return Path(fprc.__path__[0]) / "__pycache__" / f"sources-{version}.json"
