"""What MATLAB, HDF5, NumPy, TDMS, Parquet and ROS files hold: named arrays, or why one is none."""

import json
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import numpy as np

from fprc.errors import LogError
from fprc.logs.columns import open_hdf5, refuse_never_written
from fprc.recordings.table import Column

#: Names of parts, each with its array, or with the reason why it cannot be a channel.
Parts = Iterator[tuple[str, Column | str]]
#: Attributes of HDF5 and fields of a struct that hold a unit, and a label, as Simulink writes them;
#: attributes that name the columns of a matrix.
_UNITS = ("units", "unit", "Units", "Unit")
_LABELS = ("long_name", "label", "Label", "Name", "name", "title", "description")
_NAMES = ("columns", "names", "column_names", "labels", "fields")
#: Most numbers taken of one message of ROS; a longer one is an image or a cloud of points.
_MOST_NUMBERS = 200


def read_matlab(path: Path) -> Parts:
    """Read every array of a MATLAB file, any version.

    Structs, struct arrays and cell arrays are split into parts, named as in MATLAB: ``s.y``,
    ``s(2).y``, ``c{1}.y``, and so are tables and timetables: ``T.y``. Durations become seconds,
    dates seconds since 1970.
    """
    from matio import load_from_mat

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of objects that are not numbers
        content = load_from_mat(str(path))
    for name, value in content.items():
        if not name.startswith("__"):
            yield from _of_matlab(name, value)


def _of_matlab(name: str, thing: Any) -> Parts:
    from pandas import DataFrame

    if isinstance(thing, DataFrame):  # a table, or a timetable, whose times are the index
        table = thing.reset_index() if thing.index.name else thing
        yield from ((f"{name}.{column}", Column(table[column].to_numpy())) for column in table)
    elif not isinstance(thing, np.ndarray | str):
        fields = getattr(thing, "properties", None)
        fields = fields if isinstance(fields, dict) else {}
        parts = [part for field in fields for part in _of_matlab(f"{name}.{field}", fields[field])]
        yield from parts
        if not any(isinstance(part, Column) and np.size(part.values) > 1 for _, part in parts):
            kind = getattr(thing, "classname", type(thing).__name__)
            yield name, f"a {kind} of MATLAB; save its times and values as a struct or a table"
    elif isinstance(thing, str) or thing.dtype.kind == "U":
        return
    elif thing.dtype.names:
        for index, element in enumerate(thing.ravel("F"), 1):
            place = name if thing.size == 1 else f"{name}({index})"
            fields = {field: element[field] for field in thing.dtype.names}
            unit, label = _text(fields, _UNITS), _text(fields, _LABELS)
            for field, value in fields.items():
                for part, found in _of_matlab(f"{place}.{field}", value):
                    if isinstance(found, Column):
                        found = Column(found.values, found.unit or unit, found.label or label)
                    yield part, found
    elif thing.dtype == object and thing.size:
        for index, element in enumerate(thing.ravel("F"), 1):
            yield from _of_matlab(f"{name}{{{index}}}" if thing.ndim else name, element)
    else:
        yield name, Column(thing)


def _text(fields: Any, names: Iterable[str]) -> str:
    """Return the text of the first of these fields or attributes; empty without one."""
    for found in (np.ravel(fields[name]) for name in names if name in fields):
        if found.size == 1 and isinstance(found[0], str | bytes):
            return found[0].decode(errors="replace") if isinstance(found[0], bytes) else found[0]
    return ""


def read_hdf5(path: Path) -> Parts:
    """Read every array of an HDF5 file, by its path in the file; links are not followed.

    The fields of a compound type are ``dataset.field``. A matrix whose attribute ``columns`` or
    ``names`` names its columns, or that pandas wrote, has the columns ``matrix.name``.
    """
    found: list[tuple[str, Column | str]] = []

    def visit(name: str, member: Any) -> None:
        if isinstance(member, h5py.Dataset):
            found.append((name, _of_dataset(name, member)))

    with open_hdf5(path) as file:
        file.visititems(visit)
    yield from found


def _of_dataset(name: str, dataset: h5py.Dataset) -> Column | str:
    """Return a dataset with unit and names, or, mostly from its metadata, why it is none."""
    if not dataset.size or dataset.dtype.kind not in "fiubV":
        return f"{dataset.dtype} of shape {dataset.shape}"
    if dataset.external or dataset.is_virtual:  # without that file, it would read as zeros
        return "stored in another file; copy it into this one"
    try:
        refuse_never_written(dataset)
        values = np.asarray(dataset[()])
    except (LogError, OSError, RuntimeError) as error:  # other datasets may be readable
        return f"cannot be read ({error})"
    attributes = dict(dataset.attrs)
    names = next((attributes[key] for key in _NAMES if key in attributes), ())
    items = name.rpartition("/")[2].replace("_values", "_items")  # of pandas
    if not np.size(names) and name.endswith("_values") and items in dataset.parent:
        names = dataset.parent[items][()]
    texts = [n.decode() if isinstance(n, bytes) else n for n in np.ravel(names).tolist()]
    parts = texts if all(isinstance(text, str) for text in texts) else ()
    return Column(values, _text(attributes, _UNITS), _text(attributes, _LABELS), parts)


def read_numpy(path: Path) -> Parts:
    """Read an .npz or .npy file: arrays, or the fields of a structured array.

    In an .npz file, an array of texts names the columns of a matrix.
    """
    content = np.load(path)
    if isinstance(content, np.ndarray):
        fields = {field: content[field] for field in content.dtype.names or ()}
        content = fields or {"data": content}
    arrays = dict(content.items())
    texts = [array.tolist() for array in arrays.values() if array.dtype.kind == "U" and array.ndim]
    for name, array in arrays.items():
        yield name, Column(array, parts=next((t for t in texts if len(t) in array.shape[:2]), ()))


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
    """Read a Parquet file; the unit of a column is in its metadata as ``unit`` or ``units``."""
    from pyarrow import parquet

    table = parquet.read_table(path)
    for name, column in zip(table.column_names, table.columns, strict=True):
        metadata = table.schema.field(name).metadata or {}
        unit = metadata.get(b"unit") or metadata.get(b"units") or b""
        yield name, Column(column.to_numpy(), unit.decode())


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

    def decoder_for(encoding: str, schema: Any) -> Any:
        return json.loads if encoding == "json" else lambda content: {}

    others: Any = SimpleNamespace(decoder_for=decoder_for)
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory(), others])
        yield from _of_messages(
            (channel.topic, message.log_time, content)
            for _, channel, message, content in reader.iter_decoded_messages()
        )


def _of_messages(messages: Iterable[tuple[str, int, Any]]) -> Parts:
    """Yield the numbers in messages by topic, ``topic/field.part``, with ``topic/time``, in s."""
    topics: dict[str, list[dict[str, float]]] = {}
    for topic, stamp, message in messages:
        found = dict(_numbers("", message))
        if len(found) <= _MOST_NUMBERS:
            topics.setdefault(topic.strip("/"), []).append({"time": 1e-9 * stamp, **found})
    for topic, rows in topics.items():
        for name in dict.fromkeys(name for row in rows for name in row):
            values = np.array([row.get(name, np.nan) for row in rows])
            yield f"{topic}/{name}", Column(values, "s" if name == "time" else "")


def _numbers(name: str, thing: Any) -> Iterator[tuple[str, float]]:
    if isinstance(thing, int | float | np.number):
        yield name, float(thing)
    elif isinstance(thing, list | tuple | np.ndarray) and len(thing) <= _MOST_NUMBERS:
        for k, part in enumerate(thing):
            yield from _numbers(f"{name}[{k}]", part)
    elif isinstance(thing, dict) or hasattr(thing, "__slots__") or hasattr(thing, "__dict__"):
        if not isinstance(thing, dict):
            names = getattr(thing, "__slots__", None) or vars(thing)
            thing = {key: getattr(thing, key) for key in names}
        for key, part in thing.items():
            if not key.startswith("_"):
                yield from _numbers(f"{name}.{key}".lstrip("."), part)
