"""Find the raw logs, results and sidecars of a build, and what forbids releasing them."""

import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fprc.artifacts import read_json
from fprc.errors import FprcError
from fprc.provenance import sha256

#: Keys by which a JSON file is recognised as a sidecar.
_SIDECAR = {"commit", "dirty", "config_sha256", "versions", "inputs", "outputs"}


def built(root: Path, configfiles: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the raw logs and results of `all`, sorted, and those that are missing or outdated.

    Raises
    ------
    FprcError
        Quotes Snakemake if it failed.
    """
    command = [sys.executable, "-m", "snakemake", "--cores", "1", "--nolock", "--summary"]
    chosen = ["--configfile", *configfiles] if configfiles else []
    done = subprocess.run(
        [*command, *chosen, "--", "all"], cwd=root, capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise FprcError(f"Snakemake: {(done.stderr or done.stdout).strip()}")
    rows = [line.split("\t") for line in done.stdout.splitlines()[1:]]
    unfinished = [name for name, *_, status, plan in rows if (status, plan) != ("ok", "no update")]
    return sorted(name for name, *_ in rows), sorted(unfinished)


def sidecars_of(root: Path, files: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Return the contents of the sidecars among the files."""
    present = [name for name in files if name.endswith(".json") and (root / name).is_file()]
    contents = {name: read_json(root / name) for name in present}
    return {name: content for name, content in contents.items() if content.keys() >= _SIDECAR}


def in_checkout(name: str) -> str:
    """Return a file of a sidecar as a path in the checkout; the package's are ``fprc/...``."""
    return f"src/{name}" if name.startswith("fprc/") else name


def problems_of(
    root: Path,
    unfinished: Sequence[str],
    sidecars: Mapping[str, Mapping[str, Any]],
    commit: str,
) -> list[str]:
    """Return why the results cannot be released, as texts; none if they can."""
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
        *_first(unfinished, "missing or outdated; run `make paper`"),
        *_first(elsewhere, f"not made by this commit, {commit[:12]}; {again}"),
        *_first(dirty, f"made with uncommitted changes; {again}"),
        *(["results were made with different versions of libraries; " + again]
          if len(environments) > 1 else []),
        *changed,
    ]  # fmt: skip


def _first(names: Sequence[str], what: str) -> list[str]:
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    return [f"{names[0]}{more}: {what}"] if names else []
