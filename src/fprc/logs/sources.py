"""Read CSV, HDF5 and MATLAB files of other programs."""

from pathlib import Path
from typing import Any

from fprc.errors import LogError
from fprc.given import open_given
from fprc.logs.arrays import read_arrays
from fprc.logs.delimited import read_text
from fprc.logs.isolated import isolated_each
from fprc.logs.variables import Source

_SUFFIXES = {
    ".csv": "CSV", ".tsv": "CSV", ".txt": "CSV", ".dat": "CSV",
    ".h5": "HDF5", ".hdf5": "HDF5", ".hdf": "HDF5", ".mat": "MATLAB",
}  # fmt: skip


def read_source(path: Path | str, **layout: Any) -> Source:
    """Read every variable of a file that can be a channel.

    HDF5 and MATLAB files are read in a child process, because their libraries can hang or
    crash on a damaged file.

    Parameters
    ----------
    **layout
        Layout of a text file, see ``read_text``.

    Raises
    ------
    LogError
        The file cannot be opened, is not in the format that its name's ending stands for, or is
        too large.
    """
    path = Path(path)
    kind = _SUFFIXES.get(path.suffix.lower())
    if kind is None:
        raise LogError(f"{path}: unknown file name ending; must be one of {', '.join(_SUFFIXES)}")
    open_given(path, error=LogError).close()
    if kind == "CSV":
        return read_text(path, **layout)
    (source,) = isolated_each(read_arrays, [path], matlab=kind == "MATLAB")
    return source
