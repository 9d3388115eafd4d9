"""What a folder of raw logs holds, without reading their samples."""

import json
from collections.abc import Container, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from fprc.errors import LogError
from fprc.logs.columns import read_header
from fprc.logs.quality import something_else
from fprc.logs.raw import RAW_CHANNELS


class Holding(NamedTuple):
    """One log: its channels (None: every one), and what an import said of them."""

    channels: frozenset[str] | None
    notes: Mapping[str, str]

    def lacks(self, names: Sequence[str]) -> list[str]:
        """Return those of the named channels that the log does not have."""
        if self.channels is None:
            return []
        return [name for name in names if name not in self.channels]

    def having(self, names: Sequence[str]) -> "Holding":
        """Return the same log with these channels, as what their names say."""
        channels = None if self.channels is None else self.channels | {*names}
        notes = {name: note for name, note in self.notes.items() if name not in names}
        return Holding(channels, notes)

    def instead(self, name: str) -> str | None:
        """Return what a channel holds in place of what its name says, if it does."""
        begins = something_else(name)
        note = self.notes.get(name, "")
        return note.removeprefix(begins) if note.startswith(begins) else None


#: A log that has, or will have, every channel.
COMPLETE = Holding(None, {})


def holdings(
    folder: Path | str,
    names: Sequence[str],
    to_come: Container[str] = (),
    without: Sequence[str] = (),
) -> dict[str, Holding]:
    """Return those of the named logs that are in a folder, or will be.

    Parameters
    ----------
    names : sequence of str
        Names of logs, without ``.h5``.
    to_come : container of str
        Those that the workflow records itself; they count as complete. So do
        files that cannot be read: who reads them says what is wrong.
    without : sequence of str
        Channels that logs to come will lack all the same.
    """
    coming = Holding(frozenset(RAW_CHANNELS) - set(without), {}) if without else COMPLETE
    found = {}
    for name in names:
        path = Path(folder) / f"{name}.h5"
        if name in to_come:
            found[name] = coming
        elif path.exists():
            found[name] = _look(path)
    return found


def _look(path: Path) -> Holding:
    try:
        channels, attributes = read_header(path)
        return Holding(channels, json.loads(attributes.get("notes", "{}")))
    except (LogError, ValueError, TypeError):
        return COMPLETE
