"""What can still be read of a damaged HDF5 log.

On a damaged file the library can wait for ever, or end the process. It therefore
reads in a child process with a time limit, which leaves each channel in a folder
as soon as it has it.
"""

import json
import shutil
import stat
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np

from fprc.errors import LogError
from fprc.logs.attributes import KINDS, OF_A_CHANNEL, is_text, read_attribute, read_attributes
from fprc.logs.columns import checksum, unit_of
from fprc.logs.hdf5 import MAX_BYTES, bytes_of, channel_of, promised_length, shown
from fprc.logs.hdf5_headers import mend_checksums
from fprc.logs.isolated import limit_process, run_limited, time_limit_s
from fprc.logs.raw import RAW_ATTRIBUTES, RAW_CHANNELS, TRACKING_CHANNELS, missing_channels

#: Most memory that the child may ask for, bytes.
_LIMIT_BYTES = 2 << 30
_KNOWN_CHANNELS = (*RAW_CHANNELS, *TRACKING_CHANNELS)
#: A raw log has room for so many channels beside those that every one has.
_MOST_OTHERS = 100
#: A promised length beyond so many times the real one is itself damaged.
_BELIEVABLE = 1000


class Salvaged(NamedTuple):
    """What came out of a damaged file."""

    #: All of one length.
    channels: dict[str, np.ndarray]
    attributes: dict[str, Any]
    #: Samples of the file that the channels no longer have.
    lost: int
    #: A sentence for each thing that is lost; none if the file is whole.
    words: list[str]


def salvage(path: Path | str, *, limit_s: float | None = None) -> Salvaged:
    """Read what can be read of a raw log; the file stays as it is.

    Each channel is read up to its first sample that cannot be. One that has less than half
    of the longest is left out, and the others are cut to the same length; each that is
    shorter than the longest is named. A channel whose
    checksum is wrong is kept, and said; where there is none a wrong number is not noticed.

    Parameters
    ----------
    limit_s : float, optional
        Time after which reading is ended; what was read until then is kept.

    Raises
    ------
    LogError
        The file cannot be opened, or no sample can be read.
    """
    path = Path(path)
    try:
        if not stat.S_ISREG(path.stat().st_mode):  # to open a pipe would take for ever
            raise LogError(f"{path}: cannot be opened (it is no file); check the path")
        path.open("rb").close()
    except OSError as error:
        raise LogError(f"{path}: cannot be opened ({error.strerror}); check the path") from error
    with tempfile.TemporaryDirectory() as folder:
        words = _read_in_child(path, folder, limit_s or time_limit_s([path]))
        channels, lengths, attributes, more = _collect(Path(folder))
    kept, left_out = _of_one_length(channels, lengths)
    words += more + left_out
    if not kept:
        raise LogError("\n".join([f"{path}: no sample can be read; nothing was written", *words]))
    gone = [name for name in RAW_ATTRIBUTES if name not in attributes]
    if gone:
        words.append(f"attributes {', '.join(gone)}: not found")
    gone = [name for name in missing_channels(attributes, kept) if name not in lengths]
    if gone:
        words.append(f"channels {', '.join(gone)}: not found")
    length = len(next(iter(kept.values())))
    lost = max(lengths.values()) - length
    if lost and "time_s" in kept:
        words.append(f"{lost} samples lost after {kept['time_s'][-1]:.3f} s")
    return Salvaged(kept, attributes, lost, words)


def _read_in_child(path: Path, folder: str, limit_s: float) -> list[str]:
    command = [sys.executable, "-m", "fprc.logs.salvage", str(limit_s), str(path), folder]
    _, ended = run_limited(command, limit_s)
    return [f"reading ended early: {ended}"] if ended else []


def _collect(
    folder: Path,
) -> tuple[dict[str, np.ndarray], dict[str, int], dict[str, Any], list[str]]:
    """Return what the child left: channels, the lengths they had, attributes, and words."""
    channels, lengths, words = {}, {}, []
    attributes: dict[str, Any] = {}
    said = folder / "said.jsonl"
    for line in said.read_text(encoding="utf-8").split("\n")[:-1] if said.exists() else ():
        entry = json.loads(line)
        attributes |= entry.get("attributes", {})
        words += entry.get("words", [])
        if "channel" in entry:
            lengths[entry["channel"]] = entry["length"]
            channels[entry["channel"]] = np.load(folder / entry["file"])
    return channels, lengths, attributes, words


def _of_one_length(
    channels: Mapping[str, np.ndarray], lengths: Mapping[str, int]
) -> tuple[dict[str, np.ndarray], list[str]]:
    """Cut channels to the shortest of those that are kept, and say what is lost of each."""
    longest = max((len(values) for values in channels.values()), default=0)
    kept = {name: values for name, values in channels.items() if 2 * len(values) >= longest > 0}
    common = min((len(values) for values in kept.values()), default=0)
    words = []
    for name, values in channels.items():
        there, length = len(values), lengths[name]
        fate = "" if name in kept else "; left out of the copy"
        if there < length:
            words.append(f"{name}: {length - there} of {length} samples lost{fate}")
        elif there < longest:
            words.append(f"{name}: {there} samples, but others have up to {longest}{fate}")
    return {name: values[:common] for name, values in kept.items()}, words


# --- in the child process ------------------------------------------------------------------


def _leave(path: Path, folder: Path) -> None:
    """Read a file channel by channel and leave each as a file beside ``said.jsonl``."""
    size = path.stat().st_size
    patched = folder / "patched.h5"
    shutil.copyfile(path, patched)
    _restore_length(patched, size)
    with (folder / "said.jsonl").open("w", encoding="utf-8") as said:

        def say(**what: Any) -> None:
            said.write(json.dumps(what) + "\n")
            said.flush()

        if patched.stat().st_size > size:
            say(words=[f"cut short: {size} of {patched.stat().st_size} bytes are there"])
        wrong = _mend_headers(patched)
        if wrong:
            say(words=[f"headers damaged: {wrong}; what they say may be wrong"])
        try:
            file = h5py.File(patched, "r")
        except Exception as error:  # a damaged file makes the library raise whatever it likes
            say(words=[f"cannot be opened as HDF5 ({error})"])
            return
        _leave_attributes(file, say, doubtful=wrong > 0)
        _leave_channels(file, size, folder, say)


def _leave_attributes(file: h5py.File, say: Callable[..., None], *, doubtful: bool) -> None:
    known = [name for name in KINDS if name not in OF_A_CHANNEL]
    names, listed = _names(file.attrs, known)
    found = []
    for name in names:
        try:
            value, words = _attribute(file.attrs, name)
            say(attributes={name: value}, words=words)
            found.append(name)
        except Exception as error:
            if listed:
                say(words=[f"attribute {shown(name)}: left out ({error})"])
    # which ones there were nobody knows
    if doubtful and found:
        say(words=[f"attributes {', '.join(found)}: may be wrong"])
    lost = [name for name in known if name not in (*found, *RAW_ATTRIBUTES)]
    if doubtful or not listed:
        say(words=[f"attributes {', '.join(lost)}: lost if they were there"])


def _leave_channels(file: h5py.File, size: int, folder: Path, say: Callable[..., None]) -> None:
    room = MAX_BYTES
    names, listed = _names(file, _KNOWN_CHANNELS)
    if not listed:
        say(words=["channels: they cannot be listed; any but the usual ones are lost"])
    first = [name for name in _KNOWN_CHANNELS if name in names]
    rest = [name for name in names if name not in _KNOWN_CHANNELS]
    if len(rest) > _MOST_OTHERS:
        say(words=[f"{len(rest) - _MOST_OTHERS} channels left out: there are too many"])
    for k, name in enumerate([*first, *rest[:_MOST_OTHERS]]):
        try:
            values, length, words = _values(file, name, size, room)
        except Exception as error:
            if listed:
                say(words=[f"{shown(name)}: cannot be read ({error})"])
            continue
        room -= values.nbytes
        np.save(folder / f"{k}.npy", values)
        say(channel=name, length=length, file=f"{k}.npy", words=words)


def _restore_length(path: Path, size: int) -> None:
    """Append as many zeros as were cut off; the library opens no file that is too short."""
    with path.open("r+b") as file:
        promised = promised_length(file.read(52))
        if size < promised <= _BELIEVABLE * size:
            file.truncate(promised)


def _mend_headers(path: Path) -> int:
    """Give headers their checksums, without which the library opens none; return how many."""
    data = bytearray(path.read_bytes())
    wrong = mend_checksums(data)
    if wrong:
        path.write_bytes(data)
    return wrong


def _names(members: Mapping[str, Any], known: Sequence[str]) -> tuple[Sequence[str], bool]:
    """Return the names of the members, and whether the file lists them."""
    try:
        return tuple(members), True
    except Exception:
        # the list is damaged; single members may still be found
        return known, False


def _attribute(attributes: h5py.AttributeManager, name: str) -> tuple[Any, list[str]]:
    """Return an attribute, and words if it is no longer the same."""
    if not is_text(name):
        raise LogError("its name is not UTF-8")
    try:
        return read_attribute(attributes, name), []
    except LogError:
        mended = read_attribute(attributes, name, mend=True)
    return mended, [f"attribute {shown(name)}: what was not UTF-8 is replaced"]


def _values(file: h5py.File, name: str, size: int, room: int) -> tuple[np.ndarray, int, list[str]]:
    """Return a channel's samples up to the first that is lost, how many there were, and words."""
    if not is_text(name):
        raise LogError("its name is not UTF-8")
    dataset = channel_of(file, name)
    told, wrong = read_attributes(dataset.attrs)
    unit = wrong.get("units") or told.get("units", unit_of(name))
    if unit != unit_of(name):
        raise LogError(f"units are {unit}, must be {unit_of(name)}")
    if bytes_of(dataset) > room:
        raise LogError(
            f"declares {len(dataset)} samples; a log may take {MAX_BYTES >> 20} MB of memory"
        )
    length = len(dataset)
    if dataset.chunks:
        values = _values_of_chunks(dataset, size)
    else:
        offset, item = dataset.id.get_offset(), dataset.dtype.itemsize
        there = length if offset is None else min(max((size - offset) // item, 0), length)
        if there * item > size:
            raise LogError(f"{length} samples do not fit into {size} bytes")
        values = dataset[:there].astype(np.float64)
    words = []
    if name in _KNOWN_CHANNELS and "units" not in told:
        words.append(f"{name}: attribute units: not found; taken for {unit_of(name)}")
    if len(values) == length and told.get("crc32", checksum(values)) != checksum(values):
        words.append(f"{name}: its checksum is wrong; some of its numbers may be wrong")
    return values, length, words


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
    limit_process(_LIMIT_BYTES, float(sys.argv[1]))
    _leave(Path(sys.argv[2]), Path(sys.argv[3]))
