"""HDF5 files that may be damaged, or made to do harm: what is judged before samples are read."""

import math
import os
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from fprc.errors import LogError
from fprc.escape import visible

#: Most that the channels of one file may take in memory, bytes: 7 h of ten channels at 200 Hz.
MAX_BYTES = 384 << 20

#: Where superblocks keep the length of the file, by their version.
_LENGTH_AT = {0: 40, 1: 44, 2: 28, 3: 28}


@contextmanager
def opened(path: Path) -> Iterator[h5py.File]:
    """Open a file to read it; what the library raises meanwhile becomes an error for people.

    Raises
    ------
    LogError
        The file cannot be opened, is cut short or damaged.
    """
    refuse_cut_file(path)
    try:
        with h5py.File(path, "r") as file:
            yield file
    except LogError:
        raise
    except Exception as error:  # a damaged file makes the library raise whatever it stumbles over
        raise LogError(
            f"{path}: cannot be read as HDF5 ({error}); the file is cut short or damaged, "
            "restore it, or delete it and record it again"
        ) from error


def refuse_cut_file(path: Path, at: int = 0) -> None:
    """Compare an HDF5 file's length with the one that its superblock, ``at`` bytes in, promises.

    A file cut inside its header can make the library wait for ever.

    Raises
    ------
    LogError
        The file cannot be opened, is no HDF5, or is cut short.
    """
    try:
        found = path.stat()
        if not stat.S_ISREG(found.st_mode):  # to open a pipe would take for ever
            raise LogError(f"{path}: cannot be opened (it is no file); check the path")
        with path.open("rb") as file:
            file.seek(at)
            head = file.read(52)
    except OSError as error:
        raise LogError(f"{path}: cannot be opened ({error.strerror}); check the path") from error
    if head[:8] != b"\x89HDF\r\n\x1a\n":
        raise LogError(f"{path}: not an HDF5 file; raw logs are described in data/raw/README.md")
    size = found.st_size
    promised = promised_length(head)
    if len(head) < 48 or size < promised:
        total = f" of {promised}" if promised else ""
        raise LogError(
            f"{path}: cut short, {size}{total} bytes are left; restore it, or delete it and "
            "record it again"
        )


def promised_length(head: bytes) -> int:
    """Return the length that a superblock says the file has; 0 if it cannot be told."""
    begin = _LENGTH_AT.get(head[8] if len(head) > 8 else -1, len(head))
    number = head[begin : begin + 8]
    return int.from_bytes(number, "little") if len(number) == 8 else 0


def links_of(file: h5py.File) -> list[str]:
    """Return the names in a file that stand for something elsewhere; none is followed."""
    found = []

    def note(name: bytes, info: h5py.h5l.LinkInfo) -> None:
        if info.type != h5py.h5l.TYPE_HARD:
            found.append(name.decode("utf-8", "surrogateescape"))

    file.id.links.iterate(note, info=True)
    return found


def channel_of(file: h5py.File, name: str) -> h5py.Dataset:
    """Return the dataset of a channel, of which all samples are in the file itself.

    Raises
    ------
    LogError
        Says why it cannot be used; the message names neither file nor channel.
    """
    link = file.get(name, getlink=True)
    if isinstance(link, h5py.ExternalLink):
        where = visible(f"{link.filename} {link.path}")
        raise LogError(f"is a link to another file, {where}; copy the samples into this one")
    if isinstance(link, h5py.SoftLink):
        raise LogError(f"is a link to {visible(link.path)}; copy the samples into a dataset")
    dataset = None if link is None else file.get(name)
    if not isinstance(dataset, h5py.Dataset):
        raise LogError(f"missing; the file has {listed(file)}")
    if dataset.is_virtual or dataset.external:
        raise LogError("its samples are in another file; copy them into this one")
    if dataset.ndim != 1 or dataset.dtype.kind not in "fiu":
        raise LogError(
            f"must be one number per sample, not {dataset.dtype} of shape {dataset.shape}"
        )
    return dataset


def refuse_never_written(dataset: h5py.Dataset) -> None:
    """Check that no sample of a channel is one that the library makes up.

    It does so of those that were never written; a small file can declare any number of them.

    Raises
    ------
    LogError
        Some were never written; the message does not name the channel.
    """
    layout = dataset.id.get_create_plist().get_layout()
    if layout == h5py.h5d.CHUNKED:
        there = dataset.id.get_num_chunks() >= -(-len(dataset) // dataset.chunks[0])
    else:
        there = layout == h5py.h5d.COMPACT or dataset.id.get_offset() is not None
    if len(dataset) and not there:
        raise LogError(
            f"declares {len(dataset)} samples, and not all of them were ever written; record the "
            "log again"
        )


def bytes_of(dataset: h5py.Dataset) -> int:
    """Return what a channel takes in memory, bytes; a chunk is read as a whole."""
    samples = max(dataset.size, math.prod(dataset.chunks or ()))
    return samples * max(dataset.dtype.itemsize, 8)


def too_large(datasets: Iterable[h5py.Dataset]) -> str:
    """Return why channels are not to be read together; empty if they may be."""
    sizes = {dataset: bytes_of(dataset) for dataset in datasets}
    total = sum(sizes.values())
    if total <= MAX_BYTES:
        return ""
    largest = max(sizes, key=sizes.__getitem__)
    return (
        f"channel {largest.name.lstrip('/')}: declares {largest.size} samples; all channels "
        f"would take {total >> 20} MB and may take {MAX_BYTES >> 20} MB; the file is damaged, or "
        "too large: split it"
    )


def shown(name: str | bytes) -> str:
    """Return a name in a file for a message; the library gives bytes of what is not UTF-8."""
    return visible(os.fsdecode(name))


def listed(names: Iterable[str], most: int = 12) -> str:
    """Return names for a message, the first ones if there are many."""
    found = list(names)
    more = f" and {len(found) - most} more" if len(found) > most else ""
    return (", ".join(map(shown, found[:most])) or "none") + more
