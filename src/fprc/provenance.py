"""Where a result comes from, and whether it was changed after its rule wrote it."""

import hashlib
import json
import os
import platform
import subprocess
from collections.abc import Iterable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from fprc.errors import FprcError

_LIBRARIES = (
    "fprc", "numpy", "scipy", "pandas", "scikit-learn", "numba", "h5py", "matplotlib",
    "snakemake",
)  # fmt: skip


def hash_of(settings: Mapping[str, Any]) -> str:
    """Return the SHA-256 of settings, independent of the order of their keys."""
    text = json.dumps(settings, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def versions() -> dict[str, str]:
    """Return the version of Python and of each library that the workflow computes or draws with."""
    return {"python": platform.python_version(), **{name: version(name) for name in _LIBRARIES}}


def commit_of(package: Path) -> str:
    """Return the commit of a package's code, with ``-dirty`` where a tracked file was changed.

    A package installed into a folder that git does not track has no commit.
    """
    if _git(package, "ls-files", "--error-unmatch", "__init__.py") is None:
        return "unknown (not a git checkout)"
    return _git(package, "describe", "--always", "--dirty", "--exclude=*", "--abbrev=12") or "none"


def _git(folder: Path, *arguments: str) -> str | None:
    command = ["git", "--no-optional-locks", "-C", str(folder), *arguments]
    # a hook of git sets git's variables
    env = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True, env=env)
    except (OSError, subprocess.CalledProcessError):
        return None
    return done.stdout.strip()


def digest_of(path: str | Path, results: str | Path) -> Path:
    """Return the file with the SHA-256 of a result, in the format of ``sha256sum --check``."""
    return Path(results, "digests", f"{Path(path).relative_to(results)}.sha256")


def write_digests(paths: Iterable[str], results: str | Path) -> None:
    """Write the SHA-256 of results, which ``changed_results`` compares."""
    for path in paths:
        digest = digest_of(path, results)
        digest.parent.mkdir(parents=True, exist_ok=True)
        digest.write_text(f"{sha256(path)}  {path}\n", encoding="utf-8")


def changed_results(results: str | Path, paths: Iterable[str] | None = None) -> list[str]:
    """Return the results that were damaged or edited after their rule wrote them.

    Parameters
    ----------
    results : path
        Folder of the results.
    paths : iterable of str, optional
        Files to look at; default: all that have a digest. Those without one are left out.
    """
    if paths is None:
        digests = Path(results, "digests")
        known = sorted(digests.rglob("*.sha256"))
        paths = [str(Path(results, file.relative_to(digests).with_suffix(""))) for file in known]
    return [
        path
        for path in paths
        if Path(path).is_relative_to(results)
        and Path(path).is_file()
        and (digest := digest_of(path, results)).is_file()
        and digest.read_bytes().split()[:1] != [sha256(path).encode()]
    ]


def refuse_changed(results: str | Path, paths: Iterable[str]) -> None:
    """Raise FprcError if ``changed_results`` returns a file; it names every one."""
    found = changed_results(results, paths)
    if found:
        raise FprcError(
            "\n".join(
                f"{path}: was damaged or edited after its rule wrote it; delete it and repeat the "
                "command"
                for path in found
            )
        )


def sha256(path: str) -> str:
    """Return the SHA-256 of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
