"""Checks of HDF5 files that may be damaged or malicious, before any sample is read."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from fprc.errors import LogError
from fprc.escape import visible
from fprc.given import open_given

#: The first bytes of an HDF5 file.
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
#: First bytes of a model file, which is an HDF5 file behind a block.
_MODEL = b"fprc model"


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
            head = given.read(len(_MODEL))
        if head == _MODEL:
            raise LogError(f"{path}: is a model, no log; give the log")
        if not head.startswith(_SIGNATURE):
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


def channel_of(file: h5py.File, name: str) -> h5py.Dataset:
    """Return the dataset of a channel.

    Raises
    ------
    LogError
        It is missing, does not hold one number per sample, or is stored in another file. The
        message names neither file nor channel.
    """
    link = file.get(name, getlink=True)
    if isinstance(link, h5py.ExternalLink | h5py.SoftLink):
        raise LogError(f"is a link to {visible(link.path)}; copy the samples into a dataset here")
    dataset = None if link is None else file.get(name)
    if not isinstance(dataset, h5py.Dataset):
        every = [visible(os.fsdecode(name)) for name in file]  # bytes: the name is not UTF-8
        more = f" and {len(every) - 12} more" if len(every) > 12 else ""
        raise LogError(f"missing; the file has {', '.join(every[:12]) or 'none'}{more}")
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
    status = dataset.id.get_space_status()
    if dataset.size and status != h5py.h5d.SPACE_STATUS_ALLOCATED:
        part = status == h5py.h5d.SPACE_STATUS_PART_ALLOCATED
        raise LogError(
            f"declares {dataset.size:,} numbers, but {'not all were' if part else 'none was'} ever "
            "written; record the file again"
        )
