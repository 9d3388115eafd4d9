"""Fingerprint of the code that a rule runs: the workflow reruns a rule when its code changes.

Snakemake does not track the code of an installed package, so an edit under src/ would leave stale
results. Each rule's params therefore include a hash of its stage's module and of every module
that this imports, without comments and docstrings.
"""

import ast
import hashlib
import sys
from collections.abc import Iterator
from functools import cache
from importlib.util import resolve_name
from pathlib import Path
from sysconfig import get_path

import fprc

#: Folder of Python's standard library; names of the folders of installed packages.
_STANDARD = get_path("stdlib")
_INSTALLED = {"site-packages", "dist-packages"}

#: What can hold an import or a docstring. Most of a module is expressions, which cannot.
_BLOCKS = (ast.stmt, ast.excepthandler, ast.match_case)


def fingerprint(*modules: str) -> str:
    """Hash the code of modules, and of every module of this package or the user that they import.

    ``from package import name`` includes the module that defines the name, not all modules that
    the package imports. A module of the user is included only if this process has imported it.
    """
    lines = sorted(f"{module} {_source(module)[0]}" for module in _closure(modules))
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16]


def _closure(modules: tuple[str, ...]) -> set[str]:
    seen: set[str] = set()
    todo = list(modules)
    while todo:
        module = todo.pop()
        if module not in seen:
            seen.add(module)
            todo += [_defining(*imported) for imported in _source(module)[1] if _path(imported[0])]
    return seen


def _defining(module: str, name: str) -> str:
    """Return the module that defines ``name``, or ``name`` itself if that is a module."""
    if not name or _path(f"{module}.{name}"):
        return f"{module}.{name}".removesuffix(".")
    path = _path(module)
    if path and path.name == "__init__.py":
        for origin, imported in _source(module)[1]:
            if imported == name and origin != module and _path(origin):
                return _defining(origin, name)
    return module


@cache
def _path(module: str) -> Path | None:
    """Return the file of a module of this package or of the user; None for a library."""
    package, *rest = module.split(".")
    if package == "fprc":
        path = Path(fprc.__path__[0]).joinpath(*rest)
        files = (path / "__init__.py", path.with_suffix(".py"))
        return next((file for file in files if file.is_file()), None)
    path = Path(getattr(sys.modules.get(module), "__file__", None) or "")
    # libraries may be outside this environment: those of the system, or of the user
    is_library = path.is_relative_to(_STANDARD) or _INSTALLED.intersection(path.parts)
    return None if is_library or path.suffix != ".py" else path


@cache
def _source(module: str) -> tuple[str, set[tuple[str, str]]]:
    """Return a hash of a module's code, and its imports: module, and name or ""."""
    # a model of models.others may be in a library
    path = _path(module) or Path(sys.modules[module].__file__ or "")
    tree = ast.parse(path.read_bytes())
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    imports = set(_imports(tree, package))
    for node in _statements(tree):
        match getattr(node, "body", None):
            case [ast.Expr(ast.Constant(str())), *_] as body:
                body.pop(0)
    return hashlib.sha256(ast.dump(tree).encode()).hexdigest(), imports


def _imports(tree: ast.AST, package: str) -> Iterator[tuple[str, str]]:
    """Yield every import of a module, at any depth, except those under TYPE_CHECKING."""
    for node in _statements(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            origin = resolve_name("." * node.level + (node.module or ""), package)
            yield from ((origin, alias.name) for alias in node.names)


def _statements(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield a module and its statements, at any depth, except those under TYPE_CHECKING."""
    yield tree
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, _BLOCKS) and not (
            isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        ):
            yield from _statements(node)
