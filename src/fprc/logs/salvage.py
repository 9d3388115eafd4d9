"""Read as much as possible of a damaged HDF5 log.

On a damaged file the library can hang or crash. A child process with a time limit therefore
reads the file, and saves each channel in a folder as soon as it is read.
"""

import json
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np

from fprc.errors import LogError
from fprc.logs.attributes import CHANNEL_ATTRIBUTES, KINDS, is_text, read_attribute, read_attributes
from fprc.logs.columns import checksum, unit_of
from fprc.logs.hdf5 import MAX_BYTES, bytes_of, channel_of, head_of, promised_length, shown
from fprc.logs.hdf5_headers import correct_checksums
from fprc.logs.isolated import limit_process, run_limited, time_limit_s
from fprc.logs.raw import RAW_ATTRIBUTES, RAW_CHANNELS, TRACKING_CHANNELS, missing_channels

#: Limit on the child's address space, bytes.
_LIMIT_BYTES = 2 << 30
_KNOWN_CHANNELS = (*RAW_CHANNELS, *TRACKING_CHANNELS)
#: Most channels that are read besides the known ones.
_MOST_OTHERS = 100
#: Largest file that is salvaged: it is copied, and a sparse one would fill the disk.
_LARGEST_BYTES = 4 << 30
#: A length in the superblock above this multiple of the file's real length counts as damaged.
_LARGEST_FACTOR = 1000


class Salvaged(NamedTuple):
    """Readable content of a damaged file."""

    channels: dict[str, np.ndarray]  #: all of the same length
    attributes: dict[str, Any]
    lost: int  #: number of the file's samples that the channels lack
    messages: list[str]  #: one for each loss; empty if the file is undamaged


def salvage(path: Path | str, *, limit_s: float | None = None) -> Salvaged:
    """Read as much as possible of a raw log; the file is not changed.

    Each channel is read up to its first unreadable sample. Channels with less than half the
    samples of the longest one are left out, and the others are cut to the same length. Messages
    name every short channel, and every one that is kept although its checksum is wrong. Without
    a checksum, wrong numbers go unnoticed.

    Parameters
    ----------
    limit_s : float, optional
        Limit on processor time, s; channels read until then are kept.

    Raises
    ------
    LogError
        The file cannot be opened, or no sample can be read.
    """
    path = Path(path)
    head_of(path)  # refuses a file that cannot be opened
    if (size := path.stat().st_size) > _LARGEST_BYTES:
        raise LogError(
            f"{path}: has {size:,} bytes; a damaged log of more than {_LARGEST_BYTES:,} is not "
            "copied for reading, check the path"
        )
    with tempfile.TemporaryDirectory() as folder:
        limit_s = limit_s or time_limit_s([path])
        arguments = [str(limit_s), str(os.getpid()), str(path), folder]
        _, ended = run_limited([sys.executable, "-m", "fprc.logs.salvage", *arguments], limit_s)
        channels, lengths, attributes, messages = _collect(Path(folder))
    kept, left_out = _of_one_length(channels, lengths)
    messages = [*([f"reading ended early: {ended}"] if ended else []), *messages, *left_out]
    if not kept:
        raise LogError(
            "\n".join([f"{path}: no sample can be read; nothing was written", *messages])
        )
    gone = [name for name in RAW_ATTRIBUTES if name not in attributes]
    if gone:
        messages.append(f"attributes {', '.join(gone)}: not found")
    gone = [name for name in missing_channels(attributes, kept) if name not in lengths]
    if gone:
        messages.append(f"channels {', '.join(gone)}: not found")
    length = len(next(iter(kept.values())))
    lost = max(lengths.values()) - length
    if lost and "time_s" in kept:
        messages.append(f"{lost} samples lost after {kept['time_s'][-1]:.3f} s")
    return Salvaged(kept, attributes, lost, messages)


def _collect(
    folder: Path,
) -> tuple[dict[str, np.ndarray], dict[str, int], dict[str, Any], list[str]]:
    """Return what the child saved: channels, their lengths in the file, attributes, messages."""
    channels, lengths, messages = {}, {}, []
    attributes: dict[str, Any] = {}
    report = folder / "report.jsonl"
    for line in report.read_text(encoding="utf-8").split("\n")[:-1] if report.exists() else ():
        entry = json.loads(line)
        attributes |= entry.get("attributes", {})
        messages += entry.get("messages", [])
        if "channel" in entry:
            lengths[entry["channel"]] = entry["length"]
            channels[entry["channel"]] = np.load(folder / entry["file"])
    return channels, lengths, attributes, messages


def _of_one_length(
    channels: Mapping[str, np.ndarray], lengths: Mapping[str, int]
) -> tuple[dict[str, np.ndarray], list[str]]:
    """Drop short channels, cut the others to one length, and return a message for each loss."""
    longest = max((len(values) for values in channels.values()), default=0)
    kept = {name: values for name, values in channels.items() if 2 * len(values) >= longest > 0}
    common = min((len(values) for values in kept.values()), default=0)
    messages = []
    for name, values in channels.items():
        read, length = len(values), lengths[name]
        suffix = "" if name in kept else "; left out of the copy"
        if read < length:
            messages.append(f"{name}: {length - read} of {length} samples lost{suffix}")
        elif read < longest:
            messages.append(f"{name}: {read} samples, but others have up to {longest}{suffix}")
    return {name: values[:common] for name, values in kept.items()}, messages


# --- in the child process ------------------------------------------------------------------


def _export(path: Path, folder: Path) -> None:
    """Read a file channel by channel; save each in ``folder``, and list them in report.jsonl."""
    size, full = path.stat().st_size, promised_length(head_of(path))
    patched = folder / "patched.h5"
    shutil.copyfile(path, patched)
    is_cut = size < full <= _LARGEST_FACTOR * size
    if is_cut:
        os.truncate(patched, full)  # pads it with zeros; the library rejects it otherwise
    with (folder / "report.jsonl").open("w", encoding="utf-8") as lines:

        def report(**entry: Any) -> None:
            lines.write(json.dumps(entry) + "\n")
            lines.flush()

        if is_cut:
            report(messages=[f"cut short: {size} of {full} bytes are left"])
        wrong = _correct_headers(patched)
        if wrong:
            report(messages=[f"headers damaged: {wrong}; their content may be wrong"])
        try:
            file = h5py.File(patched, "r")
        except Exception as error:  # on a damaged file the library raises many types
            report(messages=[f"cannot be opened as HDF5 ({error})"])
            return
        _export_attributes(file, report, doubtful=wrong > 0)
        _export_channels(file, size, folder, report)


def _export_attributes(file: h5py.File, report: Callable[..., None], *, doubtful: bool) -> None:
    known = [name for name in KINDS if name not in CHANNEL_ATTRIBUTES]
    names, listed = _names(file.attrs, known)
    read = []
    for name in names:
        try:
            value, messages = _attribute(file.attrs, name)
            report(attributes={name: value}, messages=messages)
            read.append(name)
        except Exception as error:
            if listed:
                report(messages=[f"attribute {shown(name)}: left out ({error})"])
    if doubtful and read:
        report(messages=[f"attributes {', '.join(read)}: may be wrong"])
    # it is unknown which optional attributes the file had
    lost = [name for name in known if name not in (*read, *RAW_ATTRIBUTES)]
    if doubtful or not listed:
        report(messages=[f"attributes {', '.join(lost)}: lost if the file had them"])


def _export_channels(file: h5py.File, size: int, folder: Path, report: Callable[..., None]) -> None:
    room = MAX_BYTES
    names, listed = _names(file, _KNOWN_CHANNELS)
    if not listed:
        report(messages=["channels: the list is damaged; only the standard ones can be read"])
    first = [name for name in _KNOWN_CHANNELS if name in names]
    rest = [name for name in names if name not in _KNOWN_CHANNELS]
    if len(rest) > _MOST_OTHERS:
        report(messages=[f"{len(rest) - _MOST_OTHERS} channels left out: too many channels"])
    for k, name in enumerate([*first, *rest[:_MOST_OTHERS]]):
        try:
            values, length, messages = _values(file, name, size, room)
        except Exception as error:
            if listed:
                report(messages=[f"{shown(name)}: cannot be read ({error})"])
            continue
        room -= values.nbytes
        np.save(folder / f"{k}.npy", values)
        report(channel=name, length=length, file=f"{k}.npy", messages=messages)


def _correct_headers(path: Path) -> int:
    """Correct wrong header checksums, which the library rejects; return how many there were."""
    data = bytearray(path.read_bytes())
    wrong = correct_checksums(data)
    if wrong:
        path.write_bytes(data)
    return wrong


def _names(members: Mapping[str, Any], known: Sequence[str]) -> tuple[Sequence[str], bool]:
    """Return the names of the members; if their list is damaged, the known names and False."""
    try:
        return tuple(members), True
    except Exception:
        # single members may still be readable
        return known, False


def _attribute(attributes: h5py.AttributeManager, name: str) -> tuple[Any, list[str]]:
    """Return an attribute, and a message if it had to be changed."""
    if not is_text(name):
        raise LogError("its name is not UTF-8")
    try:
        return read_attribute(attributes, name), []
    except LogError:
        decoded = read_attribute(attributes, name, lossy=True)
    return decoded, [f"attribute {shown(name)}: bytes that were not UTF-8 are replaced"]


def _values(file: h5py.File, name: str, size: int, room: int) -> tuple[np.ndarray, int, list[str]]:
    """Return a channel's readable samples, its length in the file, and messages."""
    if not is_text(name):
        raise LogError("its name is not UTF-8")
    dataset = channel_of(file, name)
    attributes, wrong = read_attributes(dataset.attrs)
    unit = wrong.get("units") or attributes.get("units", unit_of(name))
    if unit != unit_of(name):
        raise LogError(f"units are {unit}, must be {unit_of(name)}")
    if bytes_of(dataset) > room:
        raise LogError(
            f"declares {len(dataset)} samples; the limit for all channels is {MAX_BYTES >> 20} MB"
        )
    length = len(dataset)
    if dataset.chunks:
        values = _values_of_chunks(dataset, size)
    else:
        offset, item = dataset.id.get_offset(), dataset.dtype.itemsize
        present = length if offset is None else min(max((size - offset) // item, 0), length)
        if present * item > size:
            raise LogError(f"{length} samples do not fit into {size} bytes")
        values = dataset[:present].astype(np.float64)
    messages = []
    if name in _KNOWN_CHANNELS and "units" not in attributes:
        messages.append(f"{name}: attribute units: not found; assumed to be {unit_of(name)}")
    if len(values) == length and attributes.get("crc32", checksum(values)) != checksum(values):
        messages.append(f"{name}: its checksum is wrong; some of its numbers may be wrong")
    return values, length, messages


def _values_of_chunks(dataset: h5py.Dataset, size: int) -> np.ndarray:
    parts = [np.empty(0)]
    for begin in range(0, len(dataset), dataset.chunks[0]):
        chunk = dataset.id.get_chunk_info_by_coord((begin,))
        if chunk.byte_offset is None or chunk.byte_offset + chunk.size > size:
            break
        try:
            parts.append(dataset[begin : begin + dataset.chunks[0]].astype(np.float64))
        except Exception:
            break
    return np.concatenate(parts)


if __name__ == "__main__":
    limit_process(_LIMIT_BYTES, float(sys.argv[1]), int(sys.argv[2]))
    _export(Path(sys.argv[3]), Path(sys.argv[4]))
