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
    return PurePath(os.path.relpath(folder)).parts


def _checked(folder: str) -> str:
    folder = str(PurePath(folder))  # `out/` and `./out` are `out`
    if not folder.isprintable() or set("{}") & set(folder) or folder[0] in "~- ":
        raise ValueError(
            f"{folder[:60]!r}: must consist of printable characters without braces, which are "
            "wildcards for Snakemake, and not begin with ~, - or a blank"
        )
    first, *others = _path_parts(folder) or [""]
    is_above = {first, *others} <= {"..", ""}
    is_hidden = first.startswith(".") and first != ".."
    is_home = os.path.abspath(folder) == os.path.expanduser("~")
    if is_above or is_hidden or is_home or first in PROJECT_FOLDERS:
        raise ValueError(
            f"{folder[:60]!r}: must be none of the project's own, which are hidden folders and "
            f"{', '.join(sorted(PROJECT_FOLDERS))}, nor your home or what contains the project"
        )
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
