"""HDF5 files of equally long channels, each with its unit."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np

from fprc.artifacts import replacing
from fprc.errors import LogError

#: Unit of a channel by the ending of its name.
UNITS = {"_kpa": "kPa", "_deg": "deg", "_s": "s", "_v": "V"}


class Columns(NamedTuple):
    """Channels of one file, and its attributes."""

    path: Path
    channels: dict[str, np.ndarray]
    attributes: dict[str, Any]


def unit_of(name: str) -> str:
    """Return the unit that the ending of a channel's name stands for."""
    for ending, unit in UNITS.items():
        if name.endswith(ending):
            return unit
    raise LogError(f"channel {name}: its name must end in one of {', '.join(UNITS)}")


def write_columns(
    path: Path | str, channels: Mapping[str, np.ndarray], attributes: Mapping[str, Any]
) -> None:
    """Write channels and attributes under a temporary name, then rename.

    The same content gives the same bytes.
    """
    # in memory: HDF5 crashes the process at its end if it could not write all to a full disk
    with h5py.File("log", "w", driver="core", backing_store=False) as file:
        file.attrs.update(attributes)
        for name, values in channels.items():
            dataset = file.create_dataset(name, data=np.asarray(values, dtype=np.float64))
            dataset.attrs["units"] = unit_of(name)
        file.flush()
        image = file.id.get_file_image()
    with replacing(path) as temporary:
        temporary.write_bytes(image)


def read_columns(
    path: Path | str, names: tuple[str, ...], optional: tuple[str, ...] = ()
) -> Columns:
    """Read the named channels, and the optional ones that the file has.

    Raises
    ------
    LogError
        Names every problem at once, a line each: the file cannot be opened or
        is cut short, a channel is missing, has the wrong unit or shape, or
        holds a value that is not finite (with its sample).
    """
    columns, problems = gather_columns(path, names, optional)
    if problems:
        raise LogError("\n".join(problems))
    return columns


def gather_columns(
    path: Path | str, names: tuple[str, ...], optional: tuple[str, ...] = ()
) -> tuple[Columns, list[str]]:
    """Read what can be read of the named channels, and say what is wrong with them.

    Raises
    ------
    LogError
        The file cannot be opened, or is cut short.
    """
    path = Path(path)
    with _opened(path) as file:
        attributes = {key: plain(value) for key, value in file.attrs.items()}
        names = (*names, *(name for name in optional if name in file))
        channels, problems = _read_all(path, file, names)
    lengths = {name: len(values) for name, values in channels.items()}
    if len(set(lengths.values())) > 1:
        shortest = min(lengths, key=lengths.get)
        problems.append(
            f"{path}: channel {shortest}: {lengths[shortest]} samples, but others have up to "
            f"{max(lengths.values())}; record the log again"
        )
    elif 0 in lengths.values():
        problems.append(f"{path}: no samples; record the log again")
    return Columns(path, channels, attributes), problems


def read_header(path: Path | str) -> tuple[frozenset[str], dict[str, Any]]:
    """Return the names of a file's channels, and its attributes; the samples are not read.

    Raises
    ------
    LogError
        The file cannot be opened, or is cut short.
    """
    with _opened(Path(path)) as file:
        return frozenset(file), {key: plain(value) for key, value in file.attrs.items()}


@contextmanager
def _opened(path: Path) -> Iterator[h5py.File]:
    refuse_cut_file(path)
    try:
        with h5py.File(path, "r") as file:
            yield file
    except (OSError, RuntimeError, KeyError, TypeError, ValueError) as error:
        # a damaged file makes the library raise whatever it stumbles over
        raise LogError(
            f"{path}: cannot be read as HDF5 ({error}); the file is cut short or damaged, "
            "restore it, or delete it and record it again"
        ) from error


def plain(value: Any) -> Any:
    """Return an attribute of an HDF5 file as Python has it, whichever program wrote it."""
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.ravel()[0]
    if isinstance(value, np.generic):
        value = value.item()
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value


def refuse_cut_file(path: Path, at: int = 0) -> None:
    """Compare an HDF5 file's length with the one that its superblock, ``at`` bytes in, promises.

    A file cut inside its header can make the library wait for ever.

    Raises
    ------
    LogError
        The file cannot be opened, is no HDF5, or is cut short.
    """
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            file.seek(at)
            head = file.read(48)
    except OSError as error:
        raise LogError(f"{path}: cannot be opened ({error.strerror}); check the path") from error
    if head[:8] != b"\x89HDF\r\n\x1a\n":
        raise LogError(f"{path}: not an HDF5 file; raw logs are described in data/raw/README.md")
    known = len(head) == 48 and head[8] == 0  # version 0 of the superblock
    promised = int.from_bytes(head[40:48], "little") if known else 0
    if len(head) < 48 or size < promised:
        total = f" of {promised}" if promised else ""
        raise LogError(
            f"{path}: cut short, {size}{total} bytes are left; restore it, or delete it and "
            "record it again"
        )


def _read_all(
    path: Path, file: h5py.File, names: tuple[str, ...]
) -> tuple[dict[str, np.ndarray], list[str]]:
    channels: dict[str, np.ndarray] = {}
    problems = []
    for name in names:
        dataset = file.get(name)
        if not isinstance(dataset, h5py.Dataset):
            found = ", ".join(file) or "none"
            problems.append(f"{path}: channel {name}: missing; the file has {found}")
            continue
        unit = str(plain(dataset.attrs.get("units", "none")))
        if unit != unit_of(name):
            problems.append(
                f"{path}: channel {name}: units are {unit}, must be {unit_of(name)}; "
                "convert the values and set the attribute"
            )
        if dataset.ndim != 1 or dataset.dtype.kind not in "fiu":
            problems.append(
                f"{path}: channel {name}: must be one number per sample, "
                f"not {dataset.dtype} of shape {dataset.shape}"
            )
            continue
        values = dataset[:].astype(np.float64)
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            problems.append(
                f"{path}: channel {name}: sample {bad[0]} is {values[bad[0]]}, and "
                f"{bad.size - 1} more are not finite; cut them out or record again"
            )
        channels[name] = values
    return channels, problems
