"""Contents of a folder of raw logs, from their headers alone."""

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from fprc.errors import LogError
from fprc.logs.columns import read_columns
from fprc.logs.isolated import isolated_each


class Header(NamedTuple):
    """Names of the channels of a log that exists or will be recorded, and its attributes."""

    path: Path
    channels: frozenset[str]
    attributes: Mapping[str, Any]

    def lacks(self, names: Sequence[str]) -> list[str]:
        """Return those of the names that the log has no channel for."""
        return [name for name in names if name not in self.channels]

    def with_channels(self, names: Sequence[str]) -> "Header":
        """Return the header after these channels are added or replaced; they have no notes."""
        notes = self.attributes.get("notes", {})
        kept = {name: note for name, note in notes.items() if name not in names}
        return self._replace(channels=self.channels | {*names}, attributes={"notes": kept})


def headers(paths: Iterable[Path | str], *, isolate: bool) -> dict[str, Header]:
    """Return the headers of those raw logs that exist, by log name.

    Parameters
    ----------
    isolate : bool
        Read them in a child process, so that a damaged file cannot hang or crash this one.

    Raises
    ------
    LogError
        Names every file that cannot be read.
    """
    present = [path for path in map(Path, paths) if path.exists()]
    read = partial(read_columns, names=())
    logs = isolated_each(read, present) if isolate else map(read, present)
    return {log.path.stem: Header(log.path, log.names, log.attributes) for log in logs}


def refuse_other_source(existing: Mapping[str, Header], *, simulated: bool) -> None:
    """Check that the logs are all of the simulated rig, or that none is.

    Raises
    ------
    LogError
        Lists the others.
    """
    if simulated:
        why = (
            "is not a log of the simulated rig and will not be overwritten; set source: recorded "
            "to use it, or move it away"
        )
    else:
        why = (
            "is a log of the simulated rig, not of the real one; set folders.raw (and "
            "folders.results) to folders of their own"
        )
    wrong = [
        f"{header.path}: {why}"
        for header in existing.values()
        if (header.attributes.get("source") == "sim") != simulated
    ]
    if wrong:
        raise LogError("\n".join(wrong))
