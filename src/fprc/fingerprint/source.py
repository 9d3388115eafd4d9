"""A module's source as statements: what each binds, uses and imports."""

import ast
import builtins
import hashlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import fprc

#: Ways to run code that no name leads to: what uses them may run all of this package.
_DYNAMIC = (
    "importlib.import_module",
    "importlib.util",
    "pkgutil",
    "runpy",
    "sys.executable",
    "sys.modules",
)
#: Starts a process for a function that its callers name, and that counts by its name.
_STARTS_WHAT_IS_NAMED = "fprc.logs.isolated"
_DYNAMIC_BUILTINS = {"__import__", "eval", "exec", "globals"}

_BUILTINS = set(dir(builtins))
_FUNCTIONS = ast.FunctionDef | ast.AsyncFunctionDef
_IMPORTS = ast.Import | ast.ImportFrom

Names = dict[str, tuple[str, ...]]


class Statement(NamedTuple):
    """One statement at the top of a module; names are dotted.

    ``code`` is a hash without comments and docstrings. ``acts``: running it may
    matter although nobody uses what it binds. ``dynamic``: it may run anything.
    """

    code: str
    binds: tuple[str, ...]
    uses: tuple[str, ...]
    imports: tuple[str, ...]
    acts: bool
    dynamic: bool


class Source(NamedTuple):
    """Statements of a module, what the names that it imports stand for, its star imports."""

    statements: tuple[Statement, ...]
    imported: Names
    stars: tuple[str, ...]


@cache
def path_of(module: str) -> Path | None:
    """Return the file of a module of this package, or None."""
    package, *rest = module.split(".")
    if package != "fprc":
        return None
    path = Path(fprc.__path__[0]).joinpath(*rest)
    files = path / "__init__.py", path.with_suffix(".py")
    return next((file for file in files if file.is_file()), None)


@cache
def modules() -> list[str]:
    """Return the name of every module of this package."""
    root = Path(fprc.__path__[0])
    paths = (path.relative_to(root.parent).with_suffix("") for path in root.rglob("*.py"))
    return sorted(".".join(path.parts).removesuffix(".__init__") for path in paths)


def imports_of(script: Path | str) -> list[str]:
    """Return the names of this package that a script imports."""
    tree = ast.parse(Path(script).read_bytes())
    return sorted({name for name in _imports(tree, "") if _root(name) == "fprc"})


def read(content: bytes, module: str, *, is_package: bool) -> Source:
    """Read the source of a module."""
    package = module if is_package else module.rpartition(".")[0]
    tree = ast.parse(content)
    imported: Names = {}
    for node in ast.walk(tree):
        for name, target in _bindings(node, package):
            imported[name] = (*imported.get(name, ()), target)
        body = getattr(node, "body", None)
        if isinstance(body, list) and body and _is_docstring(body[0]):
            body.pop(0)
    stars = imported.pop("*", ())
    uses = [set(_uses(node)) for node in tree.body]
    defined = {name for node in tree.body for name in _binds(node)}
    used = {_root(name) for names in uses for name in names}
    statements = tuple(
        Statement(
            code=hashlib.sha256(ast.dump(node).encode()).hexdigest(),
            binds=tuple(_binds(node)),
            uses=tuple(sorted(u for u in names if _root(u) in imported.keys() | defined)),
            imports=tuple(_imports(node, package)),
            acts=_acts(node, package, imported, defined, used),
            dynamic=module != _STARTS_WHAT_IS_NAMED and _is_dynamic(node, names, imported, defined),
        )
        for node, names in zip(tree.body, uses, strict=True)
    )
    return Source(statements, imported, tuple(star.rstrip(":") for star in stars))


def _root(name: str) -> str:
    return name.replace(":", ".").partition(".")[0]


def _is_docstring(node: ast.AST) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _bindings(node: ast.AST, package: str) -> Iterator[tuple[str, str]]:
    """Yield the names that an import binds and what they stand for, as ``module:name``."""
    if isinstance(node, ast.Import):
        for alias in node.names:
            module = alias.name if alias.asname else _root(alias.name)
            yield alias.asname or module, f"{module}:"
    elif isinstance(node, ast.ImportFrom):
        for alias in node.names:
            name = "" if alias.name == "*" else alias.name
            yield alias.asname or alias.name, f"{_module(node, package)}:{name}"


def _module(node: ast.ImportFrom, package: str) -> str:
    if not node.level:
        return node.module or ""
    parents = package.split(".")[: len(package.split(".")) - node.level + 1]
    return ".".join([*parents, node.module] if node.module else parents)


def _imports(node: ast.stmt, package: str) -> Iterator[str]:
    """Yield what a statement imports, wherever in it."""
    for part in ast.walk(node):
        if isinstance(part, ast.Import):
            yield from (alias.name for alias in part.names)
        elif isinstance(part, ast.ImportFrom):
            yield from (target.replace(":", ".") for _, target in _bindings(part, package))


def _binds(node: ast.stmt) -> Iterator[str]:
    """Yield the names that a statement defines."""
    if isinstance(node, _FUNCTIONS | ast.ClassDef):
        yield node.name
    elif not isinstance(node, _IMPORTS):
        for part in ast.walk(node):
            if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store):
                yield part.id
            elif isinstance(part, _FUNCTIONS | ast.ClassDef):
                yield part.name


def _uses(node: ast.AST) -> Iterator[str]:
    """Yield the names in a statement, each with the attributes that follow it."""
    todo: list[ast.AST] = [node]
    while todo:
        part = todo.pop()
        name = _dotted(part)
        if name:
            yield name
            continue
        todo.extend(ast.iter_child_nodes(part))
        for field in ("annotation", "returns"):
            for inner in ast.walk(getattr(part, field, None) or ast.Pass()):
                if isinstance(inner, ast.Constant) and isinstance(inner.value, str):
                    todo.append(_parsed(inner.value))


def _dotted(node: ast.AST) -> str:
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        value = _dotted(node.value)
        return value and f"{value}.{node.attr}"
    return ""


def _parsed(annotation: str) -> ast.AST:
    try:
        return ast.parse(annotation, mode="eval")
    except SyntaxError:
        return ast.Pass()


def _acts(node: ast.stmt, package: str, imported: Names, defined: set[str], used: set[str]) -> bool:
    """Return whether a statement may do more, when the module is imported, than bind names."""

    def is_ours(name: str) -> bool:
        targets = imported.get(_root(name), ())
        return _root(name) in defined or any(_root(target) == "fprc" for target in targets)

    if isinstance(node, _IMPORTS):
        names = (name for name, target in _bindings(node, package) if _root(target) != "fprc")
        return not used.issuperset(names)
    if isinstance(node, _FUNCTIONS | ast.ClassDef):
        unusual = isinstance(node, ast.ClassDef) and (
            node.keywords or any(isinstance(part, _IMPORTS) for part in ast.walk(node))
        )
        return bool(unusual) or any(map(is_ours, _calls_at_import(node)))
    if isinstance(node, ast.Assign | ast.AnnAssign):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        plain = all(isinstance(target, ast.Name | ast.Tuple) for target in targets)
        return not plain or not _BUILTINS.issuperset(map(_root, _calls(node)))
    return not isinstance(node, ast.Pass)


def _calls_at_import(node: ast.stmt) -> Iterator[str]:
    """Yield what is called when a statement is run, not the functions that it defines."""
    if not isinstance(node, _FUNCTIONS | ast.ClassDef):
        yield from _calls(node)
        return
    for decorator in node.decorator_list:
        yield _dotted(decorator)
        yield from _calls(decorator)
    if isinstance(node, ast.ClassDef):
        for part in node.body:
            yield from _calls_at_import(part)
    else:
        for default in (*node.args.defaults, *filter(None, node.args.kw_defaults)):
            yield from _calls(default)


def _calls(node: ast.AST) -> Iterator[str]:
    for part in ast.walk(node):
        if isinstance(part, ast.Call) and (name := _dotted(part.func)):
            yield name


def _is_dynamic(node: ast.stmt, uses: set[str], imported: Names, defined: set[str]) -> bool:
    absolute = {
        ".".join([*filter(None, target.split(":")), *use.split(".")[1:]])
        for use in uses
        for target in imported.get(_root(use), ())
    }
    return (
        "importlib" in absolute
        or any(f"{name}.".startswith(f"{way}.") for name in absolute for way in _DYNAMIC)
        or not _DYNAMIC_BUILTINS.isdisjoint(uses - defined - imported.keys())
        or any(_hooks(part) for part in ast.walk(node))
    )


def _hooks(node: ast.AST) -> bool:
    """Return whether a class meets its subclasses without being asked by name."""
    if isinstance(node, ast.ClassDef):
        return any(_dotted(base) == "type" for base in node.bases)
    name = getattr(node, "attr", None) or (isinstance(node, _FUNCTIONS) and node.name)
    return name in ("__init_subclass__", "__subclasses__")
