"""HDF5 files of channels of equal length, each with a unit and checksums, and of attributes."""

import errno
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import h5py
import numpy as np
from pydantic import BeforeValidator, ConfigDict, Field, Strict, TypeAdapter, ValidationError

from fprc.artifacts import replacing
from fprc.channels import unit_of
from fprc.errors import LogError
from fprc.given import open_given, parse_object

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


def _object(text: Any) -> dict[str, Any]:
    try:
        content = parse_object(text)
        json.dumps(content, allow_nan=False)  # refuses NaN and infinity
    except (ValueError, TypeError, RecursionError) as error:
        raise ValueError(f"must hold a JSON object ({error!s:.200})") from error
    return content


#: Type of each known attribute. ``units`` belongs to a channel, all others to the file.
_TEXT = Annotated[str, Strict(False)]  # also bytes
_KINDS: dict[str, Any] = {
    **dict.fromkeys(("experiment", "source", "software", "started", "units"), _TEXT),
    **dict.fromkeys(("controller", "reference", "model", "model_file", "model_sha256"), _TEXT),
    **dict.fromkeys(("incomplete_reason", "imported_from", "imported_sha256"), _TEXT),
    **dict.fromkeys(("settle_s", "imported_start_s"), float),
    "sample_rate_hz": Annotated[float, Field(gt=0.0)],
    **dict.fromkeys(("seed", "lost_samples"), int),
    **dict.fromkeys(
        ("rig", "statistics", "recordings", "map"),
        Annotated[dict[str, Any], BeforeValidator(_object)],
    ),
    "notes": Annotated[dict[str, str], BeforeValidator(_object)],
    "complete": bool,
}
#: What parses them, and those of other programs, of which plain ones are kept.
_STRICT = ConfigDict(strict=True, allow_inf_nan=False)
_KNOWN = {name: TypeAdapter[Any](kind, config=_STRICT) for name, kind in _KINDS.items()}
_OTHER = TypeAdapter[Any](_TEXT | bool | int | float, config=_STRICT)


class Columns(NamedTuple):
    """Channels and attributes of a log; of one that was not read whole, some channels."""

    path: Path
    channels: dict[str, np.ndarray]
    attributes: dict[str, Any]
    names: frozenset[str] = frozenset()  #: of all its channels, read or not


def write_columns(
    path: Path | str, channels: Mapping[str, np.ndarray], attributes: Mapping[str, Any]
) -> None:
    """Write channels and attributes to a file under a temporary name, then rename it.

    HDF5 keeps a checksum of each channel (``fletcher32``), and its own of everything else. The
    same content gives the same bytes. LogError: the name of a channel does not end in a unit.
    """
    with h5py.File("log", "w", **_IN_MEMORY) as file:
        file.attrs.update({name: _as_written(value) for name, value in attributes.items()})
        for name, values in channels.items():
            numbers = np.asarray(values, np.float64)
            # one chunk needs no index, which would have no checksum
            checked = {"chunks": numbers.shape, "fletcher32": True} if numbers.size else {}
            dataset = file.create_dataset(name, data=numbers, **checked)
            dataset.attrs["units"] = _as_written(unit_of(name))
        file.flush()
        image = file.id.get_file_image()
    with replacing(path) as temporary:
        temporary.write_bytes(image)


def _as_written(value: Any) -> Any:
    """Return a number or text as HDF5 stores it; all else as JSON, with null for NaN and infinity.

    Text has a fixed length: one of variable length would lie outside the checksums of HDF5.
    """
    if not isinstance(value, str | bool | int | float | np.generic):
        value = json.dumps(json.loads(json.dumps(value), parse_constant=lambda text: None))
    if isinstance(value, str):
        text = value.encode("utf-8", "backslashreplace")  # a name that is not UTF-8 has surrogates
        return np.array(text, dtype=h5py.string_dtype("utf-8", max(len(text), 1)))
    return value


def read_each(read: Callable[..., Any], paths: Sequence[Path | str], **keywords: Any) -> list[Any]:
    """Read several files by a function of a path; LogError lists the errors of all files."""
    results, problems = [], []
    for path in paths:
        try:
            results.append(read(path, **keywords))
        except LogError as error:
            problems.append(str(error))
    if problems:
        raise LogError("\n".join(problems))
    return results


def read_columns(
    path: Path | str,
    names: tuple[str, ...],
    optional: tuple[str, ...] = (),
    attributes: tuple[str, ...] = (),
) -> Columns:
    """Read the named channels, and the optional ones that the file has; and all attributes.

    LogError lists every problem, one per line: the file cannot be opened or is cut short; one of
    the required ``attributes`` is missing, or one has the wrong type; a channel is missing, is
    stored in another file, has the wrong unit or shape, was changed on the disk, or holds a value
    that is not finite or beyond ``LARGEST`` (with its sample).
    """
    channels: dict[str, np.ndarray] = {}
    problems = []
    with _opened(Path(path)) as file:
        present = frozenset(file)  # `name in file` would follow a link
        for name in (*names, *(name for name in optional if name in present)):
            try:
                channels[name] = _read(file, name)
            except LogError as error:
                problems.append(f"channel {name}: {error}")
        valid, wrong = _attributes(file.attrs)
        missing = dict.fromkeys((name for name in attributes if name not in file.attrs), "missing")
    lengths = {len(values): name for name, values in channels.items()}
    if len(lengths) > 1 or 0 in lengths:
        problems.append(
            f"channel {lengths[min(lengths)]}: {min(lengths)} samples, others have up to "
            f"{max(lengths)}; record the log again"
        )
    for name, problem in (wrong | missing).items():
        problems.append(f"attribute {name}: {problem}; see data/raw/README.md")
    if problems:
        raise LogError("\n".join(f"{path}: {problem}" for problem in problems))
    return Columns(Path(path), channels, valid, present)


def read_attributes(path: Path | str) -> dict[str, Any]:
    """Return the attributes of a log that are as they must be; LogError as ``read_columns``."""
    with _opened(Path(path)) as file:
        return _attributes(file.attrs)[0]


def _attributes(holder: h5py.AttributeManager) -> tuple[dict[str, Any], dict[str, str]]:
    """Return the valid attributes of a file or dataset, and what is wrong with known ones."""
    valid, wrong = {}, {}
    for name in holder:
        try:
            stored = np.squeeze(holder[name]).tolist()
            if isinstance(stored, str):
                stored = stored.encode("utf-8", "surrogateescape")  # as it is in the file
            valid[name] = _KNOWN.get(name, _OTHER).validate_python(stored)
        except (ValidationError, TypeError) as error:  # TypeError: numpy has no such type
            if name in _KNOWN:
                why = error.errors()[0]["msg"] if isinstance(error, ValidationError) else str(error)
                wrong[name] = why.removeprefix("Value error, ")
    return valid, wrong


def _read(file: h5py.File, name: str) -> np.ndarray:
    """Return the samples of a channel; LogError if something is wrong with them."""
    dataset = file.get(name)
    if not isinstance(dataset, h5py.Dataset):
        raise LogError(f"missing; the file has {', '.join(map(repr, file)) or 'none':.200}")
    if dataset.ndim != 1 or dataset.dtype.kind not in "fiu":
        raise LogError(
            f"is {dataset.dtype} of shape {dataset.shape}; must be one number per sample"
        )
    refuse_absent(dataset)
    unit = _attributes(dataset.attrs)[0].get("units", "none")
    if unit != unit_of(name):
        raise LogError(
            f"units are {unit}, must be {unit_of(name)}; convert the values and set the attribute"
        )
    try:
        values = dataset[:].astype(np.float64, copy=False)
    except (OSError, RuntimeError) as error:
        raise LogError(
            f"cannot be read, its numbers have changed on the disk ({error}); restore the file, "
            "or, if it is of a real rig, `fprc log repair` reads the journal beside it"
        ) from error
    bad = np.flatnonzero(~(np.abs(values) <= LARGEST))  # NaN is neither
    if bad.size:
        raise LogError(
            f"sample {bad[0]} is {values[bad[0]]:g}; not finite or beyond {LARGEST:g} in all: "
            f"{bad.size}; cut them out or record again"
        )
    return values


def refuse_absent(dataset: h5py.Dataset) -> None:
    """Raise LogError if numbers of a dataset are not in its file; the library makes them up.

    They were never written, or are in another file, which may be gone.
    """
    whole = dataset.id.get_space_status() == h5py.h5d.SPACE_STATUS_ALLOCATED
    if dataset.size and (dataset.is_virtual or dataset.external or not whole):
        raise LogError(
            f"declares {dataset.size:,} numbers, of which some or all are not in the file: write "
            "them, or copy them from the file in which they are"
        )


def open_hdf5(path: Path) -> h5py.File:
    """Open an HDF5 file for reading, also one whose writer in SWMR mode was killed or still runs.

    LogError: another program has the file open, or never closed it. OSError: it is no HDF5, cut
    short or damaged.
    """
    try:
        return h5py.File(path, "r")
    except OSError as error:
        if error.errno != errno.EAGAIN and "already open for write" not in str(error):
            raise
        with suppress(OSError):
            return h5py.File(path, "r", swmr=True)
        raise LogError(
            f"{path}: is open for writing in another program, or that ended without closing it; "
            "close it there, or copy the file and close the copy with `h5clear -s`, a tool of HDF5"
        ) from error


@contextmanager
def _opened(path: Path) -> Iterator[h5py.File]:
    """Open a file for reading; turn the library's exceptions into ``LogError``."""
    open_given(path, error=LogError).close()
    try:
        with open_hdf5(path) as file:
            yield file
    except LogError:
        raise
    except Exception as error:  # on a damaged file the library raises many types
        raise LogError(
            f"{path}: not a log in HDF5, or cut short or damaged ({error}); restore it from a copy "
            "or its journal, or record it again; `fprc import` reads those of other programs"
        ) from error
