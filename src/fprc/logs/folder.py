"""What a folder of raw logs holds, without reading their samples."""

from collections.abc import Container, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from fprc.errors import LogError
from fprc.logs.columns import read_header
from fprc.logs.isolated import isolated_each
from fprc.logs.quality import something_else
from fprc.logs.raw import RAW_CHANNELS


class Header(NamedTuple):
    """What a log says of itself: the names of its channels, and its attributes."""

    path: Path
    channels: frozenset[str]
    attributes: Mapping[str, Any]


class Content(NamedTuple):
    """One log: its channels (None: every one), and what an import said of them."""

    channels: frozenset[str] | None
    notes: Mapping[str, str]

    def lacks(self, names: Sequence[str]) -> list[str]:
        """Return those of the named channels that the log does not have."""
        if self.channels is None:
            return []
        return [name for name in names if name not in self.channels]

    def having(self, names: Sequence[str]) -> "Content":
        """Return the same log with these channels, as what their names say."""
        channels = None if self.channels is None else self.channels | {*names}
        notes = {name: note for name, note in self.notes.items() if name not in names}
        return Content(channels, notes)

    def instead(self, name: str) -> str | None:
        """Return what a channel holds in place of what its name says, if it does."""
        begins = something_else(name)
        note = self.notes.get(name, "")
        return note.removeprefix(begins) if note.startswith(begins) else None


#: A log that has, or will have, every channel.
WHOLE = Content(None, {})


def headers(paths: Iterable[Path | str], *, alone: bool) -> dict[str, Header]:
    """Return what those of the raw logs that are there say of themselves, by name.

    Parameters
    ----------
    alone : bool
        Read them in a process of its own, so that no damaged file can hang or end this one.

    Raises
    ------
    LogError
        Names every file that cannot be read.
    """
    there = [path for path in map(Path, paths) if path.exists()]
    if alone and there:
        found = isolated_each(read_header, there)
    else:
        found = list(map(read_header, there))
    return {path.stem: Header(path, *each) for path, each in zip(there, found, strict=True)}


def contents(
    there: Mapping[str, Header],
    names: Sequence[str],
    to_come: Container[str] = (),
    without: Sequence[str] = (),
) -> dict[str, Content]:
    """Return those of the named logs that are there, or will be.

    Parameters
    ----------
    there : Mapping
        See ``headers``.
    names : sequence of str
        Names of logs, without ``.h5``.
    to_come : container of str
        Those that the workflow records itself; they count as complete.
    without : sequence of str
        Channels that logs to come will lack all the same.
    """
    coming = Content(frozenset(RAW_CHANNELS) - set(without), {}) if without else WHOLE
    found = {}
    for name in names:
        if name in to_come:
            found[name] = coming
        elif name in there:
            told = there[name]
            found[name] = Content(told.channels, told.attributes.get("notes", {}))
    return found


def refuse_to_overwrite(there: Mapping[str, Header]) -> None:
    """Check that no log which the simulated rig would replace is anything else.

    Raises
    ------
    LogError
        Lists those that are.
    """
    _refuse(
        [told.path for told in there.values() if told.attributes.get("source") != "sim"],
        "is not a log of the simulated rig and will not be overwritten; set source: recorded to "
        "use it, or move it away",
    )


def refuse_simulated(there: Mapping[str, Header]) -> None:
    """Check that no log in the place of a real rig's is a simulated one.

    Raises
    ------
    LogError
        Lists those that are.
    """
    _refuse(
        [told.path for told in there.values() if told.attributes.get("source") == "sim"],
        "is a log of the simulated rig, not of the real one; set folders.raw (and "
        "folders.results) to folders of their own",
    )


def _refuse(paths: Sequence[Path], why: str) -> None:
    if paths:
        raise LogError("\n".join(f"{path}: {why}" for path in paths))
