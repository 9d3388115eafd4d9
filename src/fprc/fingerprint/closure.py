"""Which code a function can reach: by the names that it uses, through imports, statically."""

import hashlib
from collections.abc import Collection
from functools import cache

from fprc.fingerprint.known import keep, source_of
from fprc.fingerprint.source import modules, path_of


def fingerprint(*roots: str, without: Collection[str] = ()) -> str:
    """Hash the code that can run when ``roots`` run.

    Counted are the functions, classes and constants of this package that are
    reached by name, and of every module that is imported on the way, what
    acts by being imported. Comments, docstrings and layout do not count.
    Where a name cannot tell what will run (a module handed on as an object,
    importlib, eval), all that could run counts.

    Parameters
    ----------
    *roots : str
        Functions, classes or modules of this package: ``fprc.experiments.comparison.judge``.
    without : collection of str
        Functions and classes that the caller knows not to be run, though a name
        leads to them: those that the settings choose between.

    Raises
    ------
    ValueError
        A name of ``without`` is not defined where it says.
    """
    closure = _closed(roots, without)
    lines = {f"{user} is {target}" for user, target in closure.bound}
    for module in sorted(closure.seen):
        statements = source_of(module).statements
        codes = [statements[index].code for index in sorted(closure.seen[module])]
        lines.add(f"{module}: {' '.join(codes)}")
    return hashlib.sha256("\n".join(sorted(lines)).encode()).hexdigest()[:16]


def reached(*roots: str, without: Collection[str] = ()) -> set[str]:
    """Return the names of what ``fingerprint`` counts, as ``module.name``."""
    closure = _closed(roots, without)
    return {
        f"{module}.{name}"
        for module, indices in closure.seen.items()
        for index in indices
        for name in source_of(module).statements[index].binds
    }


def _closed(roots: Collection[str], without: Collection[str]) -> "_Closure":
    closure = _Closure()
    for name in without:
        module, _, binding = name.rpartition(".")
        found = _binders(module).get(binding, []) if path_of(module) else []
        if not found:
            raise ValueError(f"{name}: {module} defines no {binding}; name it where it is defined")
        closure.barred |= {(module, index) for index in found}
    for root in roots:
        closure.arrive("fprc", root.split(".")[1:])
    closure.finish()
    keep()
    return closure


@cache
def _binders(module: str) -> dict[str, list[int]]:
    """Return the statements of a module by the names that they define."""
    found: dict[str, list[int]] = {}
    for index, statement in enumerate(source_of(module).statements):
        for name in statement.binds:
            found.setdefault(name, []).append(index)
    return found


class _Closure:
    """What was reached so far, and what of it is still to be followed."""

    def __init__(self) -> None:
        self.seen: dict[str, set[int]] = {}
        self.bound: set[tuple[str, str]] = set()
        self.barred: set[tuple[str, int]] = set()
        self._taken: set[tuple[str, str, bool]] = set()
        self._whole: set[str] = set()
        self._todo: list[tuple[str, int]] = []

    def finish(self) -> None:
        """Follow everything that was reached."""
        while self._todo:
            module, index = self._todo.pop()
            statement = source_of(module).statements[index]
            if statement.dynamic:
                for name in modules():
                    self.take_all(name)
            for target in statement.imports:
                self.enter(target)
            for name in statement.uses:
                self.take(module, name.split("."))

    def enter(self, name: str) -> None:
        """Import a module and its parents; the last part may be a name within the last module."""
        parts = name.split(".")
        for length in range(1, len(parts) + 1):
            module = ".".join(parts[:length])
            if module not in self.seen and path_of(module):
                self._begin(module)

    def _begin(self, module: str) -> None:
        self.seen[module] = set()
        source = source_of(module)
        for index, statement in enumerate(source.statements):
            if statement.acts:
                self._see(module, index)
            if not statement.binds:
                for target in statement.imports:
                    self.enter(target)
        for target in source.stars:
            self.take_all(target)

    def _see(self, module: str, index: int) -> None:
        if index not in self.seen[module] and (module, index) not in self.barred:
            self.seen[module].add(index)
            self._todo.append((module, index))

    def take(self, module: str, name: list[str], inside: bool = True) -> None:
        """Reach what a dotted name stands for in a module, seen from inside or from outside."""
        request = module, ".".join(name), inside
        if request in self._taken:
            return
        self._taken.add(request)
        first, *rest = name
        for index in _binders(module).get(first, ()):
            self._see(module, index)
        targets = source_of(module).imported.get(first, ())
        for target in targets:
            self._follow(f"{module}.{first}", target, rest)
        if inside or targets or first in _binders(module):
            return
        if path_of(f"{module}.{first}"):
            self.arrive(f"{module}.{first}", rest)
        elif first == "__dict__" or not first.startswith("__"):
            self.take_all(module)

    def _follow(self, user: str, target: str, rest: list[str]) -> None:
        """Reach what an import binds; that ``user`` stands for it counts too."""
        self.bound.add((user, target))
        module, _, name = target.partition(":")
        if module.split(".")[0] == "fprc":
            self.arrive(module, [name, *rest] if name else rest)

    def arrive(self, module: str, rest: list[str]) -> None:
        """Reach a dotted name in a module, or the whole module."""
        self.enter(module)
        if rest:
            self.take(module, rest, inside=False)
        else:
            self.take_all(module)

    def take_all(self, module: str) -> None:
        """Reach everything in a module, and in the modules of a package."""
        if module in self._whole or not path_of(module):
            return
        self._whole.add(module)
        self.enter(module)
        source = source_of(module)
        for index in range(len(source.statements)):
            self._see(module, index)
        for name, targets in source.imported.items():
            for target in targets:
                self._follow(f"{module}.{name}", target, [])
        for inner in modules():
            if inner.startswith(f"{module}."):
                self.take_all(inner)
