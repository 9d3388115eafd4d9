"""What another program's file holds: the one door to all formats."""

import json
import re
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple
from zipfile import ZipFile

import h5py
import numpy as np
import pandas as pd

from fprc.errors import LogError
from fprc.given import open_given
from fprc.logs.columns import open_hdf5, refuse_absent

#: Attributes of HDF5 and fields of a struct that hold a unit, a label, and names of columns.
_UNITS = ("units", "unit", "Units", "Unit")
_LABELS = ("long_name", "label", "Label", "Name", "name", "title", "description")
_NAMES = ("columns", "names", "column_names", "labels", "fields")
#: Most numbers taken of one message of ROS; a longer one is an image or a cloud of points.
_MOST_NUMBERS = 200


class Column(NamedTuple):
    """One column of a file, or, until it is split, any array in it."""

    values: np.ndarray  #: shape (n_samples,)
    unit: str = ""  #: as the file states it, outside of the column's name
    label: str = ""  #: what the file calls it besides its name
    names: Sequence[Any] = ()  #: arrays that may name the columns of a matrix


#: Names of parts, each with its array, or with the reason why it cannot be a channel.
Parts = Iterator[tuple[str, Column | str]]


class Table(NamedTuple):
    """What a file holds."""

    path: Path
    kind: str  #: file format, for messages
    columns: dict[str, Column]  #: by their names in a map
    others: dict[str, str]  #: reason why each other variable cannot be a channel, by name
    notes: tuple[str, ...] = ()  #: what was left out, or taken for what
    lines: np.ndarray | None = None  #: line number of each sample in a text file, from 1
    unusable: tuple[str, ...] = ()  #: lines among the samples that are none

    def sample(self, number: int) -> str:
        """Describe a sample, counted from 0, for a message."""
        line = "" if self.lines is None else f" (line {self.lines[number]})"
        return f"sample {number}{line}"

    def pick(self, asked: Mapping[str, str]) -> dict[str, np.ndarray]:
        """Return the columns that a map names, by its keys; LogError lists those that are none."""
        missing = [f"{key}: {name}: {self.others.get(name, 'no such column')}"
                   for key, name in asked.items() if name not in self.columns]  # fmt: skip
        if missing:
            lines = "; ".join(missing)
            raise LogError(f"{self.path}: {lines}; `fprc import {self.path} --draft` shows all")
        return {key: self.columns[name].values for key, name in asked.items()}


def read_table(path: Path | str, **layout: Any) -> Table:
    """Read every column of a file that can be a channel; its content tells its format.

    ``layout`` is that of a text, as ``importing.Csv``. LogError: the file cannot be read.
    """
    from fprc.recordings.text import read_text, read_xlsx

    path = Path(path)
    with open_given(path, error=LogError) as file:
        head = file.read(512)
    if path.suffix.lower() == ".mat" and not head.startswith(b"\x89HDF"):
        head = b"MATLAB"  # version 4 begins with a number
    known = [(kind, reader) for begin, kind, reader in _FORMATS if head.startswith(begin)]
    kind, reader = known[0] if known else ("text", None)
    try:
        if head.startswith(b"PK") and any(n.startswith("xl/") for n in ZipFile(path).namelist()):
            table = read_xlsx(path)
        elif reader is None:
            table = read_text(path, **layout)
        else:
            found = dict(pair for part in reader(path) for pair in _split(*part))
            others = {name: part for name, part in found.items() if isinstance(part, str)}
            columns = {name: part for name, part in found.items() if isinstance(part, Column)}
            table = Table(path, kind, columns, others)
    except LogError:
        raise
    except ImportError as error:
        raise LogError(
            f"{path}: {kind} needs the package {error.name}; install with: pip install "
            "'fprc[formats]'"
        ) from error
    except Exception as error:  # on a damaged file the libraries raise many types
        raise LogError(
            f"{path}: cannot be read as {kind} ({type(error).__name__}: {error}); the file is cut "
            "short, damaged, or of another format"
        ) from error
    if not table.columns and not table.others:
        raise LogError(f"{path}: has no content; the file is empty or cut short")
    return table._replace(columns=table.columns | _joined_clocks(table.columns))


def _split(name: str, part: Column | str) -> Parts:
    """Yield the columns in a part of a file, or why it cannot be a channel.

    Dates become seconds since 1970. Dimensions of length 1 are dropped. The longer dimension of a
    matrix is time; its columns are ``name[:, 0]``, its rows ``name[0, :]``, or by name ``name.x``.
    """
    if isinstance(part, str):
        yield name, part
        return
    array: Any = np.squeeze(part.values)
    if array.dtype.names:
        for field in array.dtype.names:
            yield from _split(f"{name}.{field}", part._replace(values=array[field]))
    elif array.size < 2 or array.ndim > 2 or array.dtype.kind not in "fiubmM":
        yield name, f"{array.dtype} of shape {np.shape(part.values)}"
    else:
        if array.dtype.kind in "mM":  # what is missing becomes NaN
            since = array if array.dtype.kind == "m" else array - np.datetime64(0, "s")
            array = since / np.timedelta64(1, "s")
        upright = array.shape[0] >= array.shape[-1]
        array = array.astype(np.float64, copy=False)
        named = [np.ravel(n) for n in part.names if np.size(n) == min(array.shape)]
        for k, values in enumerate(np.atleast_2d(array.T if upright else array)):
            place = f"[:, {k}]" if upright else f"[{k}, :]"
            if named and (text := _text({"": named[0][k]}, [""])):
                place = f".{text}"
            column = part._replace(values=values) if np.isfinite(values).any() else "no numbers"
            yield f"{name}{place}" if array.ndim == 2 else name, column


def _joined_clocks(columns: dict[str, Column]) -> dict[str, Column]:
    """Return the sums of columns side by side: seconds and nanoseconds, or days and times, in s."""
    joined = {}
    for (name, (coarse, *_)), (fine, (parts, unit, *_)) in pairwise(columns.items()):
        if len(coarse) != len(parts) or len(parts) < 2:
            continue
        seconds = re.search(r"(?<![a-z])secs?$", name) and re.search(r"n(ano)?secs?$", fine)
        whole = 0.0 <= parts.min() <= parts.max() < 1e9 and np.ptp(parts) > 1e6
        if seconds or (whole and 1e9 < coarse[0] < 5e9):
            total = coarse + 1e-9 * parts
        elif unit == "s" and parts[0] < 1e8 < coarse[0] and not (coarse % 86400.0).any():
            total = coarse[0] + parts  # which goes on at midnight
        else:
            continue
        joined[f"{name} + {fine}"] = Column(total, "s")
    return joined


def read_matlab(path: Path) -> Parts:
    """Read every array of a MATLAB file, in parts as MATLAB names them: ``s(2).y``, ``c{1}.y``."""
    from matio import load_from_mat

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of objects that are not numbers
        content = load_from_mat(str(path))
    for name, value in content.items():
        yield from _of_matlab(name, value)


def _of_matlab(name: str, thing: Any, unit: str = "", label: str = "") -> Parts:
    if isinstance(thing, pd.DataFrame):  # a table, or a timetable, whose times are the index
        table = thing.reset_index() if thing.index.name else thing
        yield from ((f"{name}.{column}", Column(table[column].to_numpy())) for column in table)
    elif isinstance(thing, str) or not isinstance(thing, np.ndarray):
        fields = getattr(thing, "properties", None)
        fields = fields if isinstance(fields, dict) else {}
        for field, value in fields.items():
            yield from _of_matlab(f"{name}.{field}", value)
        if not any(np.size(value) > 1 for value in fields.values()) and not isinstance(thing, str):
            kind = getattr(thing, "classname", type(thing).__name__)
            yield name, f"a {kind} of MATLAB; save its times and values as a struct or a table"
    elif thing.dtype.names:
        for index, element in enumerate(thing.ravel("F"), 1):
            place = name if thing.size == 1 else f"{name}({index})"
            fields = {field: element[field] for field in thing.dtype.names}
            about = _text(fields, _UNITS) or unit, _text(fields, _LABELS) or label
            for field, value in fields.items():
                yield from _of_matlab(f"{place}.{field}", value, *about)
    elif thing.dtype == object and thing.size:
        for index, element in enumerate(thing.ravel("F"), 1):
            place = f"{name}{{{index}}}" if thing.ndim else name
            yield from _of_matlab(place, element, unit, label)
    elif thing.dtype.kind != "U":
        yield name, Column(thing, unit, label)


def _text(fields: Any, names: Sequence[str]) -> str:
    """Return the text of the first of these fields or attributes; empty without one."""
    for found in (np.ravel(fields[name]) for name in names if name in fields):
        if found.size == 1 and isinstance(found[0], str | bytes):
            return found[0].decode(errors="replace") if isinstance(found[0], bytes) else found[0]
    return ""


def read_hdf5(path: Path) -> Parts:
    """Read every array of an HDF5 file, by its path in the file; links are not followed."""
    names: list[str] = []
    with open_hdf5(path) as file:
        file.visit(names.append)
        for name in names:
            if not isinstance(dataset := file[name], h5py.Dataset):
                continue
            try:
                refuse_absent(dataset)
                values = np.asarray(dataset[()])
            except (LogError, OSError, RuntimeError) as error:  # other datasets may be readable
                yield name, f"cannot be read ({error})"
                continue
            about, items = dataset.attrs, f"{name.removesuffix('values')}items"  # of pandas
            names_of = [about[key] for key in _NAMES if key in about]
            names_of += [file[items][()]] if items in file else []
            yield name, Column(values, _text(about, _UNITS), _text(about, _LABELS), names_of)


def read_numpy(path: Path) -> Parts:
    """Read an .npz or .npy file; an array of texts names the columns of a matrix."""
    content: Any = np.load(path)
    if isinstance(content, np.ndarray):
        content = {f: content[f] for f in content.dtype.names or ()} or {"data": content}
    texts = [array for array in content.values() if array.dtype.kind in "SU"]
    return ((name, Column(array, names=texts)) for name, array in content.items())


def read_tdms(path: Path) -> Parts:
    """Read a TDMS file of LabVIEW; the clock of a channel is ``group/channel.time``, in s."""
    from nptdms import TdmsFile

    for group in TdmsFile.read(path).groups():
        for channel in group.channels():
            name, properties = f"{group.name}/{channel.name}", channel.properties
            unit = properties.get("unit_string") or properties.get("NI_UnitDescription") or ""
            if "wf_increment" in properties and len(channel):
                yield f"{name}.time", Column(channel.time_track(), "s")
            yield name, Column(channel[:], str(unit))


def read_parquet(path: Path) -> Parts:
    """Read a Parquet file, and what pandas kept of its index."""
    from pyarrow import parquet

    table = parquet.read_table(path)
    return ((name, Column(table[name].to_numpy())) for name in table.column_names)


def read_bag(path: Path) -> Parts:
    """Read a bag of ROS 1, or the folder of a bag of ROS 2 by a file in it."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    place = path if path.suffix == ".bag" else path.parent
    with AnyReader([place], default_typestore=get_typestore(Stores.LATEST)) as reader:
        yield from _of_messages(
            (link.topic, stamp, reader.deserialize(raw, link.msgtype))
            for link, stamp, raw in reader.messages()
        )


def read_mcap(path: Path) -> Parts:
    """Read an MCAP file whose messages are of ROS 2 or JSON; of others, the times."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    ros2, messages = DecoderFactory(), []
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            encoding = channel.message_encoding
            decode = json.loads if encoding == "json" else ros2.decoder_for(encoding, schema)
            content = decode(message.data) if decode else {}
            messages.append((channel.topic, message.log_time, content))
    return _of_messages(messages)


def _of_messages(messages: Iterable[tuple[str, int, Any]]) -> Parts:
    """Return the numbers in messages by topic, ``topic/field.part``, with ``topic/time``, in s."""
    topics: dict[str, list[dict[str, float]]] = {}
    for topic, stamp, message in messages:
        found = dict(_numbers("", message))
        if len(found) <= _MOST_NUMBERS:
            topics.setdefault(topic.strip("/"), []).append({"time": 1e-9 * stamp, **found})
    for topic, rows in topics.items():
        for name, values in pd.DataFrame(rows).items():
            yield f"{topic}/{name}", Column(values.to_numpy(), "s" if name == "time" else "")


def _numbers(name: str, thing: Any) -> Iterator[tuple[str, float]]:
    parts: Any = {}
    if isinstance(thing, int | float | np.number):
        yield name, float(thing)
    elif isinstance(thing, list | tuple | np.ndarray):
        parts = {f"{name}[{k}]": part for k, part in enumerate(thing[: _MOST_NUMBERS + 1])}
    elif isinstance(thing, dict):
        parts = {f"{name}.{key}": part for key, part in thing.items()}
    elif fields := getattr(thing, "__slots__", None) or getattr(thing, "__dict__", None):
        parts = {f"{name}.{field}": getattr(thing, field) for field in fields if field[0] != "_"}
    for part, value in parts.items():
        yield from _numbers(part.lstrip("."), value)


#: How the files of a format begin, its name, and its reader.
_FORMATS: tuple[tuple[bytes, str, Callable[[Path], Parts]], ...] = (
    (b"\x89HDF", "HDF5", read_hdf5),
    (b"MATLAB", "MATLAB", read_matlab),
    (b"\x93NUMPY", "NumPy", read_numpy),
    (b"PK\x03\x04", "NumPy", read_numpy),  # or Excel
    (b"TDSm", "TDMS", read_tdms),
    (b"PAR1", "Parquet", read_parquet),
    (b"\x89MCAP0", "MCAP", read_mcap),
    (b"#ROSBAG", "ROS bag", read_bag),
    (b"SQLite format 3", "ROS 2 bag", read_bag),
)
