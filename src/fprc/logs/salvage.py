"""What can still be read of a damaged HDF5 log.

On a damaged file the library can wait for ever, or end the process. It therefore
reads in a child process with a time limit, which leaves each channel in a folder
as soon as it has it.
"""

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np

from fprc.errors import LogError
from fprc.logs.columns import plain, unit_of
from fprc.logs.raw import RAW_ATTRIBUTES, RAW_CHANNELS, missing_channels

#: Where superblocks keep the length of the file, by their version.
_LENGTH_AT = {0: 40, 1: 44, 2: 28, 3: 28}
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


def salvage(path: Path | str, *, limit_s: float = 30.0) -> Salvaged:
    """Read what can be read of a raw log; the file stays as it is.

    Each channel is read up to its first sample that cannot be. One that has less than half
    of the longest is left out, and the others are cut to the same length. HDF5 logs have
    no checksums: a wrong number inside a channel is not noticed.

    Parameters
    ----------
    limit_s : float, default=30
        Time after which reading is ended; what was read until then is kept.

    Raises
    ------
    LogError
        The file cannot be opened, or no sample can be read.
    """
    path = Path(path)
    try:
        path.open("rb").close()
    except OSError as error:
        raise LogError(f"{path}: cannot be opened ({error.strerror}); check the path") from error
    with tempfile.TemporaryDirectory() as folder:
        words = _read_in_child(path, folder, limit_s)
        channels, lengths, attributes, more = _collect(Path(folder))
    kept, left_out = _of_one_length(channels, lengths)
    words += more + left_out
    if not kept:
        raise LogError("\n".join([f"{path}: no sample can be read; nothing was written", *words]))
    gone = [name for name in RAW_ATTRIBUTES if name not in attributes]
    if gone:
        words.append(f"attributes {', '.join(gone)}: not found")
    gone = [n for n in missing_channels(attributes.get("source", ""), kept) if n not in lengths]
    if gone:
        words.append(f"channels {', '.join(gone)}: not found")
    length = len(next(iter(kept.values())))
    lost = max(lengths.values()) - length
    if lost and "time_s" in kept:
        words.append(f"{lost} samples lost after {kept['time_s'][-1]:.3f} s")
    return Salvaged(kept, attributes, lost, words)


def _read_in_child(path: Path, folder: str, limit_s: float) -> list[str]:
    command = [sys.executable, "-m", "fprc.logs.salvage", str(path), folder]
    try:
        done = subprocess.run(command, timeout=limit_s, capture_output=True, check=False)
    except subprocess.TimeoutExpired:
        return [f"reading did not end within {limit_s:g} s and was given up"]
    if done.returncode == 0:
        return []
    said = done.stderr.decode(errors="replace").strip().splitlines()
    return [f"reading ended early: {said[-1] if said else 'the HDF5 library crashed'}"]


def _collect(
    folder: Path,
) -> tuple[dict[str, np.ndarray], dict[str, int], dict[str, Any], list[str]]:
    """Return what the child left: channels, the lengths they had, attributes, and words."""
    channels, lengths, attributes, words = {}, {}, {}, []
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
        if len(values) < lengths[name]:
            fate = "" if name in kept else "; left out of the copy"
            words.append(
                f"{name}: {lengths[name] - len(values)} of {lengths[name]} samples lost{fate}"
            )
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
        try:
            file = h5py.File(patched, "r")
        except Exception as error:  # a damaged file makes the library raise whatever it likes
            say(words=[f"cannot be opened as HDF5 ({error})"])
            return
        names, listed = _names(file.attrs, tuple(RAW_ATTRIBUTES))
        for name in names:
            try:
                value = plain(file.attrs[name])
                if not isinstance(value, str | bool | int | float):
                    raise LogError("neither text nor number")
                say(attributes={name: value})
            except Exception as error:
                if listed:
                    say(words=[f"attribute {name}: cannot be read ({error})"])
        names, listed = _names(file, RAW_CHANNELS)
        for k, name in enumerate(names):
            try:
                values, length = _values(file, name, size)
            except Exception as error:
                if listed:
                    say(words=[f"{name}: cannot be read ({error})"])
                continue
            np.save(folder / f"{k}.npy", values)
            say(channel=name, length=length, file=f"{k}.npy")


def _restore_length(path: Path, size: int) -> None:
    """Append as many zeros as were cut off; the library opens no file that is too short."""
    head = path.read_bytes()[:52]
    at = _LENGTH_AT.get(head[8] if len(head) > 8 else None, len(head))
    promised = int.from_bytes(head[at : at + 8], "little")
    if size < promised <= _BELIEVABLE * size:
        with path.open("r+b") as file:
            file.truncate(promised)


def _names(members: Mapping[str, Any], known: tuple[str, ...]) -> tuple[tuple[str, ...], bool]:
    """Return the names of the members, and whether the file lists them."""
    try:
        return tuple(members), True
    except Exception:
        # the list is damaged; single members may still be found
        return known, False


def _values(file: h5py.File, name: str, size: int) -> tuple[np.ndarray, int]:
    """Return the samples of a channel up to the first that is lost, and how many there were."""
    dataset = file[name]
    if (
        not isinstance(dataset, h5py.Dataset)
        or dataset.ndim != 1
        or dataset.dtype.kind not in "fiu"
    ):
        raise LogError("not one number per sample")
    unit = dataset.attrs.get("units")
    if unit is not None and str(plain(unit)) != unit_of(name):
        raise LogError(f"units are {plain(unit)}, must be {unit_of(name)}")
    length, item = len(dataset), dataset.dtype.itemsize
    if dataset.chunks:
        return _values_of_chunks(dataset, size), length
    offset = dataset.id.get_offset()
    there = length if offset is None else min(max((size - offset) // item, 0), length)
    if there * item > size:
        raise LogError(f"{length} samples do not fit into {size} bytes")
    return dataset[:there].astype(np.float64), length


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
    _leave(Path(sys.argv[1]), Path(sys.argv[2]))
