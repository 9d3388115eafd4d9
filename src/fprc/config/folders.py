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
    first, *others = _path_parts(folder) or [".."]
    is_hidden = first.startswith(".") and first != ".."
    if {first, *others} == {".."} or is_hidden or first in PROJECT_FOLDERS:
        raise ValueError(
            f"{folder[:60]!r}: must be none of the project's own, which are hidden folders and "
            f"{', '.join(sorted(PROJECT_FOLDERS))}, nor what contains the project"
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
        if results[: len(raw)] == raw or raw[: len(results)] == results and raw[-1] != "raw":
            raise ValueError(
                f"raw = {self.raw} and results = {self.results} would mix; use {self.results}/raw, "
                "or put both side by side"
            )
        return self
