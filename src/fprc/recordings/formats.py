"""What MATLAB, HDF5, NumPy, TDMS, Parquet and ROS files hold: named arrays, or why one is none."""

import json
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
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
        for column in table:
            yield f"{name}.{column}", Column(table[column].to_numpy())
    elif not isinstance(thing, np.ndarray | str):
        parts: list[tuple[str, Column | str]] = []
        if isinstance(getattr(thing, "properties", None), dict):
            for field, value in thing.properties.items():
                parts += _of_matlab(f"{name}.{field}", value)
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
            found.extend(_of_dataset(name, member))

    def name_link(name: str, link: Any) -> None:
        if not isinstance(link, h5py.HardLink):
            where = getattr(link, "filename", "") or link.path
            found.append((name, f"a link to {where}, which is not followed"))

    with open_hdf5(path) as file:
        file.visititems(visit)
        file.visititems_links(name_link)
    yield from found


def _of_dataset(name: str, dataset: h5py.Dataset) -> Parts:
    """Yield the columns of a dataset, or, mostly from its metadata, why it has none."""
    problem = ""
    if not dataset.size or dataset.dtype.kind not in "fiubV":
        problem = f"{dataset.dtype} of shape {dataset.shape}"
    elif dataset.external or dataset.is_virtual:
        problem = "stored in another file; copy it into this one"
    try:
        refuse_never_written(dataset)
        values = np.asarray([] if problem else dataset[()])
    except (LogError, OSError, RuntimeError) as error:  # other datasets may be readable
        problem = f"cannot be read ({error})"
    if problem:
        yield name, problem
        return
    attributes = dict(dataset.attrs)
    names = next((attributes[key] for key in _NAMES if key in attributes), ())
    items = name.rpartition("/")[2].replace("_values", "_items")  # of pandas
    if not np.size(names) and name.endswith("_values") and items in dataset.parent:
        names = dataset.parent[items][()]
    texts = [n.decode() if isinstance(n, bytes) else n for n in np.ravel(names).tolist()]
    parts = texts if all(isinstance(text, str) for text in texts) else ()
    yield name, Column(values, _text(attributes, _UNITS), _text(attributes, _LABELS), parts)


def read_npz(path: Path) -> Parts:
    """Read the arrays of an .npz file; an array of texts names the columns of a matrix."""
    with np.load(path) as content:
        arrays = {name: content[name] for name in content}
    texts = [array.tolist() for array in arrays.values() if array.dtype.kind == "U" and array.ndim]
    for name, array in arrays.items():
        yield name, Column(array, parts=next((t for t in texts if len(t) in array.shape[:2]), ()))


def read_npy(path: Path) -> Parts:
    """Read an .npy file: a matrix, or a structured array, whose fields are columns."""
    array = np.load(path)
    yield from ((field, Column(array[field])) for field in array.dtype.names or ())
    if not array.dtype.names:
        yield "data", Column(array)


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
    """Read an MCAP file whose messages are of ROS 2 or JSON."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    factory, decoders = DecoderFactory(), {}
    messages = []
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            if channel.id not in decoders:
                of_json = channel.message_encoding == "json"
                decoders[channel.id] = json.loads if of_json else factory.decoder_for("cdr", schema)
            if decode := decoders[channel.id]:
                messages.append((channel.topic, message.log_time, decode(message.data)))
    return _of_messages(messages)


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
            slots = getattr(thing, "__slots__", None) or vars(thing)
            thing = {key: getattr(thing, key) for key in slots}
        for key, part in thing.items():
            if not key.startswith("_"):
                yield from _numbers(f"{name}.{key}".lstrip("."), part)
