"""Where a result comes from: code, settings, inputs, versions."""

import hashlib
import json
import os
import platform
import subprocess
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import fprc

_LIBRARIES = (
    "fprc", "numpy", "scipy", "pandas", "scikit-learn", "numba", "h5py", "matplotlib",
    "snakemake",
)  # fmt: skip


def describe(
    data: Mapping[str, Any],
    *,
    inputs: Sequence[str],
    outputs: Sequence[str],
    settings: Mapping[str, Any],
) -> dict[str, Any]:
    """Return what a reader needs to reproduce a result.

    Parameters
    ----------
    data : Mapping
        Attributes of the data: ``source``, and ``seed`` or ``seeds`` if there are any.
    inputs, outputs : sequence of str
        Files; each is given with its SHA-256. Those of this package are named ``fprc/...``.
    settings : Mapping
        The whole configuration; only its hash is kept.

    Returns
    -------
    dict
        ``source``, ``simulated`` (also true if only a part is), ``seeds``, ``commit``,
        ``dirty``, ``config_sha256``, ``versions``, ``inputs``, ``outputs``. ``commit`` and
        ``dirty`` are None where the code is not in a git checkout.
    """
    commit, dirty = checkout()
    return {
        "source": data["source"],
        "simulated": data["source"].endswith("sim"),
        "seeds": [
            int(seed) for seed in data.get("seeds", [data["seed"]] if "seed" in data else [])
        ],
        "commit": commit,
        "dirty": dirty,
        "config_sha256": hash_of(settings),
        "versions": versions(),
        "inputs": {_portable(path): sha256(path) for path in inputs},
        "outputs": {path: sha256(path) for path in outputs},
    }


def _portable(path: str) -> str:
    """Return a path; that of a file in this package as ``fprc/...``, the same on every computer."""
    package = Path(fprc.__path__[0])
    inside = Path(path).is_relative_to(package)
    return f"fprc/{Path(path).relative_to(package).as_posix()}" if inside else path


def hash_of(settings: Mapping[str, Any]) -> str:
    """Return the SHA-256 of settings, independent of the order of their keys."""
    text = json.dumps(settings, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def versions() -> dict[str, str]:
    """Return the version of Python and of each library that computes or draws."""
    installed = {"python": platform.python_version()}
    for name in _LIBRARIES:
        try:
            installed[name] = version(name)
        except PackageNotFoundError:
            continue
    return installed


def checkout(package: Path | None = None) -> tuple[str | None, bool | None]:
    """Return the commit of the running code, and whether the checkout differs from it.

    Parameters
    ----------
    package : Path, optional
        Folder of the code; default: this package. A package installed into a
        folder that git does not track has no commit.
    """
    package = package or Path(fprc.__path__[0])
    if _git(package, "ls-files", "--error-unmatch", "__init__.py") is None:
        return None, None
    commit, changes = _git(package, "rev-parse", "HEAD"), _git(package, "status", "--porcelain")
    if commit is None or changes is None:
        return None, None
    return commit, bool(changes)


def _git(folder: Path, *arguments: str) -> str | None:
    command = ["git", "--no-optional-locks", "-C", str(folder), *arguments]
    # a hook sets variables of git's own
    env = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True, env=env)
    except (OSError, subprocess.CalledProcessError):
        return None
    return done.stdout.strip()


def sha256(path: str) -> str:
    """Return the SHA-256 of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
