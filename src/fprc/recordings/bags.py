"""Recordings of ROS: bags and MCAP files. Each topic has a clock of its own."""

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fprc.recordings.table import Column, Table, gathered

#: Most numbers taken of one message; a longer one is an image or a cloud of points.
_MOST_NUMBERS = 200


def read_bag(path: Path) -> Table:
    """Read a bag of ROS 1, or the folder of a bag of ROS 2 by a file in it."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    place = path if path.suffix == ".bag" else path.parent
    with AnyReader([place], default_typestore=get_typestore(Stores.LATEST)) as reader:
        messages = (
            (link.topic, stamp, reader.deserialize(raw, link.msgtype))
            for link, stamp, raw in reader.messages()
        )
        return gathered(path, "ROS bag", _columns(messages))


def read_mcap(path: Path) -> Table:
    """Read an MCAP file whose messages are of ROS 2 or JSON."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    with path.open("rb") as file:
        reader, factory, decoders = make_reader(file), DecoderFactory(), {}

        def messages() -> Iterator[tuple[str, int, Any]]:
            for schema, channel, message in reader.iter_messages():
                if channel.id not in decoders:
                    of_json = channel.message_encoding == "json"
                    found = json.loads if of_json else factory.decoder_for("cdr", schema)
                    decoders[channel.id] = found
                if decode := decoders[channel.id]:
                    yield channel.topic, message.log_time, decode(message.data)

        return gathered(path, "MCAP", _columns(messages()))


def _columns(messages: Iterable[tuple[str, int, Any]]) -> Iterator[tuple[str, Column | str]]:
    """Yield the numbers in messages by topic, ``topic/field.part``, with ``topic/time``, in s."""
    stamps: dict[str, list[int]] = {}
    numbers: dict[str, list[dict[str, float]]] = {}
    for topic, stamp, message in messages:
        found = dict(_numbers("", message))
        if len(found) <= _MOST_NUMBERS:
            stamps.setdefault(topic.strip("/"), []).append(stamp)
            numbers.setdefault(topic.strip("/"), []).append(found)
    for topic, rows in numbers.items():
        yield f"{topic}/time", Column(1e-9 * np.array(stamps[topic], np.float64), "s")
        for name in dict.fromkeys(name for row in rows for name in row):
            yield f"{topic}/{name}", Column(np.array([row.get(name, np.nan) for row in rows]))


def _numbers(name: str, thing: Any) -> Iterator[tuple[str, float]]:
    if isinstance(thing, int | float | np.number):
        yield name, float(thing)
    elif isinstance(thing, list | tuple | np.ndarray) and len(thing) <= _MOST_NUMBERS:
        for k, part in enumerate(thing):
            yield from _numbers(f"{name}[{k}]", part)
    elif isinstance(thing, dict) or hasattr(thing, "__slots__") or hasattr(thing, "__dict__"):
        parts = thing if isinstance(thing, dict) else _fields(thing)
        for key, part in parts.items():
            yield from _numbers(f"{name}.{key}".lstrip("."), part)


def _fields(message: Any) -> dict[str, Any]:
    names = getattr(message, "__slots__", None) or vars(message)
    return {name: getattr(message, name) for name in names if not name.startswith("_")}
