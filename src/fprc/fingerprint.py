"""Fingerprint of the code that a rule runs: the workflow reruns a rule when its code changes.

Snakemake does not track the code of an installed package, so an edit under src/ would leave stale
results. Each rule's params therefore include a hash of its stage's module and of every module
that this imports, without comments and docstrings.
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
    lines = {f"{module} {_source(module).code}" for module in _closure(modules)}
    _write_cache()
    return hashlib.sha256("\n".join(sorted(lines)).encode()).hexdigest()[:16]


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
    """Return the module that defines ``name``; it may be a module, or re-exported by a package."""
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
    if key not in _parsed():
        tree = ast.parse(content)
        imports = sorted({(m, n or "") for m, n in _imports(tree)})
        for node in ast.walk(tree):
            body = getattr(node, "body", None)
            if isinstance(body, list) and body and _is_text(body[0]):
                body.pop(0)
        _parsed()[key] = [hashlib.sha256(ast.dump(tree).encode()).hexdigest(), imports]
        _new_keys.append(key)
    code, imports = _parsed()[key]
    return Source(code, [(origin, name or None) for origin, name in imports])


def _imports(tree: ast.AST) -> Iterator[tuple[str, str | None]]:
    """Yield every import of a module, at any depth, except those under TYPE_CHECKING."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, None) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from ((node.module or "", alias.name) for alias in node.names)
        elif not (isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"):
            yield from _imports(node)


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(getattr(node.value, "value", None), str)


_new_keys: list[str] = []


@cache
def _parsed() -> dict[str, Any]:
    """Return the sources parsed by earlier processes, since every job asks for the same ones."""
    with suppress(OSError, ValueError):
        kept = json.loads(_cache_file().read_text(encoding="utf-8"))
        return kept if isinstance(kept, dict) else {}
    return {}


def _write_cache() -> None:
    if _new_keys:
        _new_keys.clear()
        temporary = _cache_file().with_suffix(f".{os.getpid()}")
        with suppress(OSError):  # a folder that cannot be written to is no error
            temporary.parent.mkdir(exist_ok=True)
            temporary.write_text(json.dumps(_parsed()), encoding="utf-8")
            temporary.replace(_cache_file())


def _cache_file() -> Path:
    version = hashlib.sha256(Path(__file__).read_bytes() + sys.version.encode()).hexdigest()[:16]
    return Path(fprc.__path__[0]) / "__pycache__" / f"sources-{version}.json"
