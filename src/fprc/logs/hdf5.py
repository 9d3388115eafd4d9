"""Checks of HDF5 files that may be damaged or malicious, before any sample is read."""

import math
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from fprc.errors import LogError
from fprc.escape import visible
from fprc.given import open_given

#: Memory limit for the channels of one file, bytes: 7 h of ten channels at 200 Hz.
MAX_BYTES = 384 << 20

#: The first bytes of an HDF5 file.
SIGNATURE = b"\x89HDF\r\n\x1a\n"


@contextmanager
def opened(path: Path) -> Iterator[h5py.File]:
    """Open a file for reading; turn the library's exceptions into ``LogError``.

    Raises
    ------
    LogError
        The file cannot be opened, is no HDF5, is cut short or damaged.
    """
    try:
        with open_given(path, error=LogError) as given:
            head = given.read(len(SIGNATURE))
        if head != SIGNATURE:
            raise LogError(
                f"{path}: not an HDF5 file; `fprc import` makes a raw log from a recording of "
                "another program"
            )
        with h5py.File(path, "r") as file:
            yield file
    except LogError:
        raise
    except Exception as error:  # on a damaged file the library raises many types
        raise LogError(
            f"{path}: cannot be read as HDF5 ({error}); the file is cut short or damaged, "
            "restore it, or delete it and record it again"
        ) from error


def links_of(file: h5py.File) -> list[str]:
    """Return the names of the soft and external links in a file, without following them."""
    names = []

    def note(name: bytes, info: h5py.h5l.LinkInfo) -> None:
        if info.type != h5py.h5l.TYPE_HARD:
            names.append(name.decode("utf-8", "surrogateescape"))

    file.id.links.iterate(note, info=True)
    return names


def channel_of(file: h5py.File, name: str) -> h5py.Dataset:
    """Return the dataset of a channel.

    Raises
    ------
    LogError
        It is missing, does not hold one number per sample, or is stored in another file. The
        message names neither file nor channel.
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
            f"is {dataset.dtype} of shape {dataset.shape}; must be one number per sample"
        )
    return dataset


def refuse_never_written(dataset: h5py.Dataset) -> None:
    """Check that every number of a dataset was written.

    For numbers never written the library returns fill values, of which a small file can declare any
    number.

    Raises
    ------
    LogError
        Some numbers were never written. The message does not name the dataset.
    """
    layout = dataset.id.get_create_plist().get_layout()
    if layout == h5py.h5d.CHUNKED:
        sizes = zip(dataset.shape, dataset.chunks, strict=True)
        chunks = math.prod(-(-samples // size) for samples, size in sizes)
        missing = chunks - dataset.id.get_num_chunks()
        problem = f"{missing:,} of its {chunks:,} chunks were never written" if missing else ""
    else:
        written = layout == h5py.h5d.COMPACT or dataset.id.get_offset() is not None
        problem = "" if written else "none was written"
    if dataset.size and problem:
        raise LogError(f"declares {dataset.size:,} numbers, but {problem}; record the file again")


def bytes_of(dataset: h5py.Dataset) -> int:
    """Return the memory that reading a channel needs, bytes; chunks are read whole."""
    samples = max(dataset.size, math.prod(dataset.chunks or ()))
    return samples * max(dataset.dtype.itemsize, 8)


def too_large(datasets: Iterable[h5py.Dataset]) -> str:
    """Return an error text if the channels together exceed the memory limit, else ''."""
    sizes = {dataset: bytes_of(dataset) for dataset in datasets}
    total = sum(sizes.values())
    if total <= MAX_BYTES:
        return ""
    largest = max(sizes, key=sizes.__getitem__)
    return (
        f"channel {largest.name.lstrip('/')}: declares {largest.size} samples; all channels "
        f"need {total >> 20} MB, the limit is {MAX_BYTES >> 20} MB; the file is damaged, or too "
        "large: split it"
    )


def shown(name: str | bytes) -> str:
    """Return a name from a file as text for a message; h5py gives bytes if it is not UTF-8."""
    return visible(os.fsdecode(name))


def listed(names: Iterable[str]) -> str:
    """Return names as text for a message, at most the first twelve."""
    every = list(names)
    more = f" and {len(every) - 12} more" if len(every) > 12 else ""
    return (", ".join(map(shown, every[:12])) or "none") + more
