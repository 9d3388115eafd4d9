"""Folders for raw logs and results, which must not mix with other files."""

import os
from pathlib import PurePath
from typing import Annotated

from pydantic import AfterValidator, Field, model_validator

from fprc.config.section import Section

#: Folders of the project itself: no data may go there, nor into hidden folders.
PROJECT_FOLDERS = frozenset({"config", "docs", "profiles", "src", "tests", "tools", "workflow"})


def _path_parts(folder: str) -> tuple[str, ...]:
    """Return the parts of a folder's path, relative to the working directory."""
    path = os.path.normpath(folder)
    if os.path.isabs(path) or path.startswith(".."):
        path = os.path.relpath(path)
    return PurePath(path).parts


def _reasons_to_refuse(folder: str) -> list[str]:
    """Return every reason to refuse a folder."""
    reasons = []
    if not folder.isprintable():
        reasons.append("contains characters that cannot be printed")
    if "{" in folder or "}" in folder:
        reasons.append("contains a brace, which is a wildcard for Snakemake")
    if any(name != name.strip() for name in PurePath(folder).parts):
        reasons.append("contains a name that begins or ends with a blank")
    if folder.startswith("~"):
        reasons.append("begins with ~, which is not expanded; write out your home folder")
    if folder.startswith("-"):
        reasons.append("begins with -, which commands read as an option")
    place = _path_parts(folder)
    if set(place) <= {".."}:
        reasons.append("is the project's folder, or contains it")
    elif place[0] in PROJECT_FOLDERS or (place[0].startswith(".") and place[0] != ".."):
        reserved = ", ".join(sorted(PROJECT_FOLDERS))
        reasons.append(f"is in {place[0]}; hidden folders and {reserved} are the project's own")
    elif os.path.abspath(folder) == os.path.expanduser("~"):
        reasons.append("is your home folder")
    return reasons


def _checked(folder: str) -> str:
    # `out/` and `./out` are `out`
    folder = str(PurePath(folder))
    reasons = _reasons_to_refuse(folder)
    if reasons:
        shown = repr(folder) if len(folder) < 60 else f"{folder[:60]!r}..."
        raise ValueError(f"{shown} {', and '.join(reasons)}; choose another folder")
    return folder


Folder = Annotated[str, AfterValidator(_checked)]


class Folders(Section):
    """Where files go.

    Inside the results folder, the raw folder must be one named raw; the results folder may not be
    inside the raw one. Neither may be in one of the project's own folders, or contain the project.
    Names consist of printable characters without braces.
    """

    raw: Folder = Field("data/raw", min_length=1, description="raw logs")
    results: Folder = Field("results", min_length=1, description="everything generated")

    @model_validator(mode="after")
    def _folders_differ(self) -> "Folders":
        raw, results = _path_parts(self.raw), _path_parts(self.results)
        if raw == results:
            raise ValueError(f"raw and results are both {self.raw}; give each its own folder")
        if results[: len(raw)] == raw:
            raise ValueError(
                f"results = {self.results} is inside raw = {self.raw}; put raw inside results, or "
                "both side by side"
            )
        below = raw[len(results) :] if raw[: len(results)] == results else ()
        if below and "raw" not in below:
            raise ValueError(f"raw = {self.raw} is among the results; use {self.results}/raw")
        return self
