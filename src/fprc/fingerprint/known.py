"""Sources that were read before: kept on disk, since every job's process asks again."""

import hashlib
import json
import os
import sys
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import fprc
from fprc.fingerprint import source
from fprc.fingerprint.source import Source, Statement, path_of, read


@cache
def source_of(module: str) -> Source:
    """Return the source of a module of this package."""
    path = path_of(module)
    content = path.read_bytes()
    key = f"{path.name} {hashlib.sha256(content).hexdigest()}"
    kept = _kept().get(module)
    if kept is not None and kept["key"] == key:
        statements = tuple(Statement(*values) for values in kept["statements"])
        return Source(statements, kept["imported"], kept["stars"])
    found = read(content, module, is_package=path.name == "__init__.py")
    _kept()[module] = {"key": key, **found._asdict()}
    _fresh.add(module)
    return found


def keep() -> None:
    """Write down what was read anew; a folder that cannot be written to is no error."""
    if not _fresh:
        return
    _fresh.clear()
    path = _path()
    temporary = path.with_suffix(f".{os.getpid()}")
    try:
        path.parent.mkdir(exist_ok=True)
        temporary.write_text(json.dumps(_kept()), encoding="utf-8")
        temporary.replace(path)
    except OSError:
        with suppress(OSError):
            temporary.unlink()


_fresh: set[str] = set()


@cache
def _kept() -> dict[str, dict[str, Any]]:
    try:
        return json.loads(_path().read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


@cache
def _path() -> Path:
    """Return the file, named after the code that reads sources and after this Python."""
    digest = hashlib.sha256(Path(source.__file__).read_bytes() + sys.version.encode())
    folder = Path(fprc.__path__[0]) / "__pycache__"
    return folder / f"sources-{digest.hexdigest()[:16]}.json"
