"""Folders for raw logs and results, and which ones would do harm."""

import os
from pathlib import PurePath
from typing import Annotated

from pydantic import AfterValidator, Field, model_validator

from fprc.config.section import Section

#: Folders of the project that hold no data; hidden ones are its own too.
OWN = frozenset({"config", "docs", "profiles", "src", "tests", "workflow"})

#: Folders that the rules make among the results.
MADE = frozenset(
    {
        "benchmark", "calibration", "control", "crossval", "data", "ensemble", "figures", "logs",
        "models", "predictions", "quality", "readout", "replicates", "reservoir", "grids",
        "tables", "timing", "weights",
    }
)  # fmt: skip

_LIMIT_NAME = 255  # of Linux
#: Linux takes 4096; Snakemake's records are in paths longer by a third, below the project's.
_LIMIT_PATH = 1000


def _place(folder: str) -> tuple[str, ...]:
    """Return the way to a folder from the one that commands are run in."""
    path = os.path.normpath(folder)
    if os.path.isabs(path) or path.startswith(".."):
        path = os.path.relpath(path)
    return PurePath(path).parts


def _faults(folder: str) -> list[str]:
    """Return every reason against a folder."""
    names = PurePath(folder).parts
    found = []
    if not folder.isprintable():
        found.append("holds characters that cannot be printed")
    if "{" in folder or "}" in folder:
        found.append("holds a brace, which is a wildcard for Snakemake")
    if any(name != name.strip() for name in names):
        found.append("holds a name that begins or ends with a blank")
    if folder.startswith("~"):
        found.append("begins with ~, which nothing here replaces; write out your home folder")
    if folder.startswith("-"):
        found.append("begins with -, which commands take for an option")
    if any(len(name.encode()) > _LIMIT_NAME for name in names):
        found.append(f"holds a name of more than {_LIMIT_NAME} bytes")
    if len(folder.encode()) > _LIMIT_PATH:
        found.append(f"is longer than {_LIMIT_PATH} bytes")
    if "\0" in folder:  # no path at all
        return found
    place = _place(folder)
    if set(place) <= {".."}:
        found.append("is the project's folder, or holds it")
    elif place[0] in OWN or (place[0].startswith(".") and place[0] != ".."):
        found.append(
            f"is in {place[0]}; hidden folders and {', '.join(sorted(OWN))} are the project's"
        )
    elif os.path.abspath(folder) == os.path.expanduser("~"):
        found.append("is your home folder")
    return found


def _usable(folder: str) -> str:
    # `out/` and `./out` are `out`
    folder = str(PurePath(folder))
    found = _faults(folder)
    if found:
        shown = repr(folder) if len(folder) < 60 else f"{folder[:60]!r}..."
        raise ValueError(f"{shown} {', and '.join(found)}; choose another folder")
    return folder


Folder = Annotated[str, AfterValidator(_usable)]


class Folders(Section):
    """Where files go.

    Raw logs may lie in a folder of their own among the results, not the other way round. Neither
    goes into the project's own folders, or into one that holds the project; names are of printable
    characters without braces.
    """

    raw: Folder = Field("data/raw", min_length=1, description="raw logs")
    results: Folder = Field("results", min_length=1, description="everything generated")

    @model_validator(mode="after")
    def _apart(self) -> "Folders":
        raw, results = _place(self.raw), _place(self.results)
        if raw == results:
            raise ValueError(f"raw and results are both {self.raw}; give each its own folder")
        if results[: len(raw)] == raw:
            raise ValueError(
                f"results = {self.results} is inside raw = {self.raw}; the other way round, or "
                "side by side"
            )
        below = raw[len(results) :] if raw[: len(results)] == results else ()
        if below and below[0] in MADE:
            raise ValueError(
                f"raw = {self.raw} is where rules write results; take {self.results}/raw"
            )
        return self
