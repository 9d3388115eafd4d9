"""Where a result comes from."""

import hashlib
import platform
import subprocess
from importlib.metadata import version
from pathlib import Path

_LIBRARIES = (
    "fprc", "numpy", "scipy", "pandas", "scikit-learn", "numba", "h5py", "matplotlib",
    "snakemake",
)  # fmt: skip


def versions() -> dict[str, str]:
    """Return the version of Python and of each library that the workflow computes or draws with."""
    return {"python": platform.python_version(), **{name: version(name) for name in _LIBRARIES}}


def commit_of(package: Path) -> str:
    """Return the commit of a package's code, with ``-dirty`` where a tracked file was changed.

    A package installed into a folder that git does not track has no commit.
    """
    git = ["git", "--no-optional-locks", "-C", str(package)]
    described = ["describe", "--always", "--dirty", "--exclude=*", "--abbrev=12"]
    try:
        for command in (["ls-files", "--error-unmatch", "__init__.py"], described):
            done = subprocess.run([*git, *command], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown (not a git checkout)"
    return done.stdout.strip()


def sha256(path: str) -> str:
    """Return the SHA-256 of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
