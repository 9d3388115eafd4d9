"""Fingerprint of a module's code, so that the workflow reruns what changed.

Snakemake cannot see into an installed package: an edit under src/ would leave
stale results behind. Each rule therefore has the fingerprint of its stage
among its params.
"""

import ast
import hashlib
from functools import cache
from pathlib import Path

import grimp

import fprc


def fingerprint(*modules: str) -> str:
    """Hash modules and all of this package that they import, transitively.

    Comments, docstrings and layout do not count.
    """
    graph = _graph()
    digest = hashlib.sha256()
    upstream = [graph.find_upstream_modules(module) for module in modules]
    for name in sorted(set(modules).union(*upstream)):
        digest.update(f"{name}:{_code(name)}\n".encode())
    return digest.hexdigest()[:16]


@cache
def _graph() -> grimp.ImportGraph:
    return grimp.build_graph("fprc", cache_dir=None)


@cache
def _code(module: str) -> str:
    path = Path(fprc.__path__[0]).parent.joinpath(*module.split("."))
    source = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    tree = ast.parse(source.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list) and body and _is_docstring(body[0]):
            body.pop(0)
    return ast.dump(tree)


def _is_docstring(node: ast.AST) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )
