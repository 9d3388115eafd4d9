"""Find the raw logs, results and sidecars of a build, and what forbids releasing them."""

import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from fprc.artifacts import read_json
from fprc.provenance import sha256

#: What makes a JSON file a sidecar.
_SIDECAR = {"commit", "dirty", "config_sha256", "versions", "inputs", "outputs"}


def files_of(root: Path, folders: Mapping[str, str]) -> list[str]:
    """Return the raw logs and results of a build, relative to the checkout, sorted.

    Left out are the messages of jobs, hidden files, and folders of other results, which have
    messages of their own.
    """
    found = {*_below(root / folders["results"]), *_below(root / folders["raw"])}
    return sorted(path.relative_to(root).as_posix() for path in found)


def _below(folder: Path) -> Iterator[Path]:
    for path in folder.iterdir() if folder.is_dir() else []:
        if path.name.startswith(".") or path.name == "logs":
            continue
        if path.is_dir() and not (path / "logs").is_dir():
            yield from _below(path)
        elif path.is_file():
            yield path


def sidecars_of(root: Path, files: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Return the contents of the sidecars among the files."""
    contents = {name: read_json(root / name) for name in files if name.endswith(".json")}
    return {name: content for name, content in contents.items() if content.keys() >= _SIDECAR}


def in_checkout(name: str) -> str:
    """Return a file of a sidecar as a path in the checkout; the package's are ``fprc/...``."""
    return f"src/{name}" if name.startswith("fprc/") else name


def problems_of(root: Path, sidecars: Mapping[str, Mapping[str, Any]], commit: str) -> list[str]:
    """Return what forbids releasing the results, for people; none if nothing does."""
    if not sidecars:
        return ["no results; build them with `make paper`"]
    elsewhere = [name for name, made in sidecars.items() if made["commit"] != commit]
    dirty = [name for name, made in sidecars.items() if made["dirty"]]
    environments = {tuple(made["versions"].items()) for made in sidecars.values()}
    changed = [
        f"{name}: {file} is missing or was changed afterwards; build again"
        for name, made in sidecars.items()
        for file, expected in {**made["inputs"], **made["outputs"]}.items()
        if not (root / in_checkout(file)).is_file()
        or sha256(str(root / in_checkout(file))) != expected
    ]
    again = "build again in a new clone"
    return [
        *_first(elsewhere, f"not made by this commit, {commit[:12]}; {again}"),
        *_first(dirty, f"made with uncommitted changes; {again}"),
        *(["results were made with different versions of libraries; " + again]
          if len(environments) > 1 else []),
        *changed,
    ]  # fmt: skip


def _first(names: Sequence[str], what: str) -> list[str]:
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    return [f"{names[0]}{more}: {what}"] if names else []


def unfinished(root: Path, configfiles: Sequence[str]) -> list[str]:
    """Return Snakemake's words if it would make or repeat a result; else nothing."""
    command = [sys.executable, "-m", "snakemake", "--cores", "1", "--nolock", "--dry-run"]
    chosen = ["--configfile", *configfiles] if configfiles else []
    done = subprocess.run(
        [*command, *chosen, "--", "all"], cwd=root, capture_output=True, text=True, check=False
    )
    if done.returncode:
        return [f"Snakemake: {(done.stderr or done.stdout).strip()}"]
    if "Nothing to be done" in done.stdout + done.stderr:
        return []
    return ["results are missing or outdated; `snakemake --dry-run all` lists them"]
