"""HDF5 files of channels of equal length, each with a unit and checksums."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np

from fprc.artifacts import replacing
from fprc.channels import unit_of
from fprc.errors import LogError
from fprc.logs.attributes import as_written, read_attributes
from fprc.logs.hdf5 import channel_of, opened, refuse_never_written

#: Largest magnitude of a sample, in any unit; its square does not overflow.
LARGEST = 1e10

#: A file in memory, without padding, in the oldest format in which everything but the samples has
#: checksums. A file on a full disk would crash the process at exit.
_IN_MEMORY: dict[str, Any] = {
    "driver": "core",
    "backing_store": False,
    "libver": ("v110", "v110"),
    "meta_block_size": 1,
}


class Columns(NamedTuple):
    """Channels and attributes of a log; of one that was not read whole, some channels."""

    path: Path
    channels: dict[str, np.ndarray]
    attributes: dict[str, Any]
    unchecked: tuple[str, ...] = ()  #: names of channels without a checksum
    names: frozenset[str] = frozenset()  #: of all its channels, read or not


def write_columns(
    path: Path | str, channels: Mapping[str, np.ndarray], attributes: Mapping[str, Any]
) -> None:
    """Write channels and attributes to a file under a temporary name, then rename it.

    HDF5 keeps a checksum of each channel (``fletcher32``), and its own of everything else. The
    same content gives the same bytes.

    Raises
    ------
    LogError
        The name of a channel does not end in a unit.
    """
    with h5py.File("log", "w", **_IN_MEMORY) as file:
        file.attrs.update({name: as_written(value) for name, value in attributes.items()})
        for name, values in channels.items():
            numbers = np.asarray(values, np.float64)
            # one chunk needs no index, which would have no checksum
            checked = {"chunks": numbers.shape, "fletcher32": True} if numbers.size else {}
            dataset = file.create_dataset(name, data=numbers, **checked)
            dataset.attrs["units"] = as_written(unit_of(name))
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
        Lists every problem, one per line: the file cannot be opened or is cut short; an
        attribute has the wrong type; a channel is missing, is stored in another file, has the
        wrong unit or shape, was changed on the disk, or holds a value that is not finite or beyond
        ``LARGEST`` (with its sample).
    """
    columns, problems = gather_columns(path, names, optional)
    if problems:
        raise LogError("\n".join(problems))
    return columns


def gather_columns(
    path: Path | str,
    names: tuple[str, ...],
    optional: tuple[str, ...] = (),
    attributes: tuple[str, ...] = (),
) -> tuple[Columns, list[str]]:
    """Read those of the named channels that can be read; return them and the problems.

    Parameters
    ----------
    attributes : tuple of str
        Required attributes; all others are read too.

    Raises
    ------
    LogError
        The file cannot be opened, or is cut short.
    """
    path = Path(path)
    with opened(path) as file:
        values, problems = read_attributes(file.attrs)
        problems += [
            f"attribute {name}: missing; see data/raw/README.md"
            for name in attributes
            if name not in file.attrs
        ]
        present = frozenset(file)  # `name in file` would follow a link
        names = (*names, *(name for name in optional if name in present))
        channels, more = _read_all(file, names)
        unchecked = tuple(name for name in channels if not file[name].fletcher32)
    columns = Columns(path, channels, values, unchecked, present)
    return columns, [f"{path}: {problem}" for problem in (*more, *problems)]


def _read_all(file: h5py.File, names: tuple[str, ...]) -> tuple[dict[str, np.ndarray], list[str]]:
    """Return the channels that can be read, and the problems."""
    channels, problems = {}, []
    for name in names:
        try:
            channels[name], wrong = _read(file, name)
        except LogError as error:
            wrong = [str(error)]
        problems += [f"channel {name}: {problem}" for problem in wrong]
    return channels, problems + _wrong_lengths(channels)


def _read(file: h5py.File, name: str) -> tuple[np.ndarray, list[str]]:
    """Return the samples of a channel, and what is wrong with them."""
    dataset = channel_of(file, name)
    refuse_never_written(dataset)
    attributes, wrong = read_attributes(dataset.attrs)
    problems = [problem for problem in wrong if problem.startswith("attribute units")]
    unit = attributes.get("units", "none")
    if unit != unit_of(name) and not problems:
        problems.append(
            f"units are {unit}, must be {unit_of(name)}; convert the values and set the attribute"
        )
    try:
        values = dataset[:].astype(np.float64, copy=False)
    except (OSError, RuntimeError) as error:
        raise LogError(
            f"cannot be read, its numbers have changed on the disk ({error}); restore the file, "
            "or, if it is of a real rig, `fprc log repair` reads the journal beside it"
        ) from error
    return values, problems + _unusable(values)


def _unusable(values: np.ndarray) -> list[str]:
    bad = np.flatnonzero(~(np.abs(values) <= LARGEST))  # NaN is neither
    if not bad.size:
        return []
    return [
        f"sample {bad[0]} is {values[bad[0]]:g}; not finite or beyond {LARGEST:g} in all: "
        f"{bad.size}; cut them out or record again"
    ]


def _wrong_lengths(channels: Mapping[str, np.ndarray]) -> list[str]:
    lengths = {name: len(values) for name, values in channels.items()}
    if len(set(lengths.values())) > 1:
        shortest = min(lengths, key=lengths.__getitem__)
        return [
            f"channel {shortest}: {lengths[shortest]} samples, but others have up to "
            f"{max(lengths.values())}; record the log again"
        ]
    return ["no samples; record the log again"] if 0 in lengths.values() else []
