"""The raw logs of a folder, without their samples."""

from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path

from fprc.errors import LogError
from fprc.logs.columns import Columns, read_columns
from fprc.logs.isolated import isolated_each


def headers(paths: Iterable[Path | str], *, isolate: bool) -> dict[str, Columns]:
    """Return those raw logs that exist, without samples, by log name.

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
    return {log.path.stem: log for log in logs}


def refuse_other_source(existing: Mapping[str, Columns], *, simulated: bool) -> None:
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
        f"{log.path}: {why}"
        for log in existing.values()
        if (log.attributes.get("source") == "sim") != simulated
    ]
    if wrong:
        raise LogError("\n".join(wrong))
