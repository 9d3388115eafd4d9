"""Files of fitted models: an HDF5 file of one text and some arrays, behind a checksum.

The first 512 bytes, HDF5's user block, hold the SHA-256 of all others, so a damaged file is refused
before the HDF5 library reads it. A changed file with a new checksum is also read with care: the
library follows no link and opens no other file, and no array is larger than its file.
"""

import hashlib
import json
import math
from collections.abc import Mapping
from typing import Any

import h5py
import numpy as np

from fprc.errors import FprcError

#: Largest file, bytes: an ESN of 4,000 nodes takes 128 MB.
MOST_BYTES = 150_000_000

#: Name of the text, JSON.
_TEXT = "model"
_FORMAT = b"fprc model 1\n"
_BLOCK = 512
_HDF5 = b"\x89HDF\r\n\x1a\n"


def model_file(text: str, arrays: Mapping[str, np.ndarray]) -> bytes:
    """Return the content of a file.

    Raises
    ------
    FprcError
        It is too large, or an array is not finite.
    """
    # in memory: HDF5 on a full disk crashes the process at exit
    with h5py.File(_TEXT, "w", driver="core", backing_store=False) as file:
        file.create_dataset(_TEXT, data=np.bytes_(text.encode()))
        for name, values in arrays.items():
            _refuse_infinite(name, values)
            file.create_dataset(name, data=values)
        file.flush()
        image = file.id.get_file_image()
    if _BLOCK + len(image) > MOST_BYTES:
        raise FprcError(
            f"takes {(_BLOCK + len(image)) / 1e6:.0f} MB, the limit is {MOST_BYTES / 1e6:.0f} MB, "
            "train a smaller one"
        )
    return sealed(image)


def sealed(image: bytes) -> bytes:
    """Return an HDF5 file behind the block with its checksum."""
    return _block(image) + image


def read_model_file(content: bytes) -> tuple[Any, dict[str, np.ndarray]]:
    """Return the value of the text in a file, and every array by its name.

    Raises
    ------
    FprcError
        The file is not as it was saved, or holds anything else.
        The message does not name the file.
    """
    image = _checked_image(content)
    with h5py.File(h5py.h5f.open_file_image(image)) as file:
        names, left = list(file), len(image)
        values = {}
        for name in [_TEXT, *(other for other in names if other != _TEXT)]:
            dataset = _dataset(file, name)
            left -= dataset.nbytes
            if left < 0:
                raise FprcError(f"{name}: declares more numbers than the file has bytes; {_AGAIN}")
            values[name] = dataset[()]
    text = values.pop(_TEXT)
    if not isinstance(text, bytes):
        raise FprcError(f"{_TEXT}: must be text; {_AGAIN}")
    for name, array in values.items():
        _refuse_infinite(name, array)
    return json.loads(text, parse_float=_number, parse_constant=_number), values


_AGAIN = "train the model again"


def _block(image: bytes) -> bytes:
    return (_FORMAT + hashlib.sha256(image).hexdigest().encode() + b"\n").ljust(_BLOCK, b"\0")


def _checked_image(content: bytes) -> bytes:
    """Return a file without its first block, which holds the checksum of the others."""
    block, image = content[:_BLOCK], content[_BLOCK:]
    if block == _block(image):
        return image
    if content.startswith(_HDF5) and b"time_s" in content:  # the name of a channel
        raise FprcError("is a log, no model; give the model of `fprc train` here")
    if not content.startswith(_FORMAT):
        raise FprcError(f"holds no model of fprc; {_AGAIN}")
    raise FprcError(
        "was changed after it was saved: its SHA-256 is not the one that it holds; restore the "
        f"file, or {_AGAIN}"
    )


def _dataset(file: h5py.File, name: str) -> h5py.Dataset:
    """Return a dataset that is in the file, whole and uncompressed."""
    link = file.get(name, getlink=True)
    dataset = file.get(name) if isinstance(link, h5py.HardLink) else None
    if not isinstance(dataset, h5py.Dataset):
        raise FprcError(f"{name}: is no dataset of the file itself; {_AGAIN}")
    plain = dataset.dtype.kind in "biuf" or (name == _TEXT and dataset.dtype.kind == "S")
    layout = dataset.id.get_create_plist()
    inside = layout.get_layout() in (h5py.h5d.CONTIGUOUS, h5py.h5d.COMPACT)
    written = dataset.id.get_storage_size() == dataset.nbytes  # else it is filled while reading
    if not plain or not inside or not written or layout.get_external_count():
        raise FprcError(
            f"{name}: {dataset.dtype} of shape {dataset.shape} is not an array as fprc saves it; "
            f"{_AGAIN}"
        )
    return dataset


def _refuse_infinite(name: str, values: np.ndarray) -> None:
    if not np.all(np.isfinite(values)):
        raise FprcError(f"{name}: holds NaN or infinity; {_AGAIN}")


def _number(text: str) -> float:
    if not math.isfinite(number := float(text)):  # NaN, Infinity or 1e400
        raise FprcError(f"{_TEXT}: holds {number}; {_AGAIN}")
    return number
