"""Raw logs with damaged bytes, or with errors of the program that wrote them."""

import json
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import damage
import h5py
import hdf5_changes
import numpy as np
import signals
from judging import SAID, SAME, SILENT, Case, Ended, Step, Verdict, differing

from fprc.logs import write_raw


class Log(NamedTuple):
    """A valid log: file, content, and the positions of samples and of other bytes in the file."""

    data: bytes
    channels: dict[str, np.ndarray]
    attributes: dict[str, Any]
    payload: np.ndarray
    rest: np.ndarray


_DESCRIBED = {"sample_rate_hz": signals.RATE_HZ, "software": "fprc fuzz"}
#: Larger datasets are declared only; their samples do not exist.
_BELIEVABLE = 10**6
_CONTROL = {"control": {"k_in_kpa_per_deg": 7.0}}


@cache
def logs() -> dict[str, Log]:
    """Return a log of each kind."""
    sweep = signals.hysteresis()
    imported = {name: sweep[name] for name in ("time_s", "theta_deg", "p_exp_kpa", "p_o_kpa")}
    recorded = {name: values for name, values in sweep.items() if name != "phi_deg"}
    return {
        "sweep": _log(
            sweep, experiment="sweep", source="sim", seed=1, rig={"valve": {"leak": 0.0}}
        ),
        "track": _log(
            signals.tracking(), experiment="track_sine_0p2_fprc_pd", source="sim", seed=1,
            reference="sine_0p2", controller="fprc_pd", settle_s=0.5, rig=_CONTROL,
        ),
        "imported": _log(
            imported, experiment="complex", source="import", seed=0, rig={},
            imported_from="arm.csv", imported_sha256="0" * 64, imported_start_s=0.0,
            map=json.dumps({"experiment": "complex"}),
            notes=json.dumps({"p_o_kpa": "read as absolute"}),
        ),
        "recorded": _log(
            recorded, experiment="sweep", source="rig", seed=1, rig=_CONTROL,
            complete=True, lost_samples=0, started="2024-01-01T00:00:00.000000+00:00",
            statistics=json.dumps({"overruns": 3, "late_p99_s": 0.0004}),
        ),
    }  # fmt: skip


def _log(channels: Mapping[str, np.ndarray], **attributes: Any) -> Log:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "log.h5")
        write_raw(path, channels, **_DESCRIBED, **attributes)
        data = path.read_bytes()
        found, stored = content(path)
        numbers = np.zeros(len(data), bool)
        with h5py.File(path) as file:
            for dataset in file.values():
                for begin, size in _stretches(dataset):
                    numbers[begin : begin + size] = True
    names = {"simulated", "units", *_DESCRIBED, *attributes}
    kept = {name: value for name, value in stored.items() if name.rpartition(".")[2] in names}
    used = np.frombuffer(data, np.uint8) != 0  # most other bytes are free space
    return Log(data, found, kept, np.flatnonzero(numbers), np.flatnonzero(~numbers & used))


def _stretches(dataset: h5py.Dataset) -> list[tuple[int, int]]:
    if dataset.chunks is None:
        return [(dataset.id.get_offset(), dataset.id.get_storage_size())]
    chunks = (dataset.id.get_chunk_info(k) for k in range(dataset.id.get_num_chunks()))
    return [(chunk.byte_offset, chunk.size) for chunk in chunks]


def content(path: Path) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Return the channels and attributes of a file, read by h5py alone."""
    channels, attributes = {}, {}
    with h5py.File(path, "r") as file:
        owners = {"": file}
        for name in file:
            dataset = _get(file, name)
            if isinstance(dataset, h5py.Dataset) and (dataset.size or 0) < _BELIEVABLE:
                with suppress(OSError):  # its samples are in a missing file
                    channels[name] = np.asarray(dataset[()])
                owners[f"{name}."] = dataset
        for prefix, owner in owners.items():
            for name in owner.attrs:
                attributes[prefix + name] = _plain(owner.attrs[name])
    return channels, attributes


def _plain(value: Any) -> Any:
    """Return a value as a Python object, however its text is stored."""
    value = value.item() if getattr(value, "size", 0) == 1 else value
    return value.decode("utf-8", "surrogateescape") if isinstance(value, bytes) else value


def _get(file: h5py.File, name: str) -> Any:
    try:
        return file.get(name)
    except (OSError, RuntimeError):  # a circular link, or one to a missing file
        return None


def flipped(rng: np.random.Generator, folder: Path) -> Case:
    """Make a case with single changed bytes."""
    name, log = _any(rng)
    if rng.random() < 0.02:
        (folder / "log.h5").write_bytes(log.data)
        return case_of("raw log, flipped bytes", f"{name}: unchanged", log)._replace(sound=True)
    where = ("numbers", log.payload) if rng.random() < 0.4 else ("metadata", log.rest)
    data, change = damage.flip(rng, log.data, where[1])
    (folder / "log.h5").write_bytes(data)
    return case_of("raw log, flipped bytes", f"{name}, {where[0]}: {change}", log)


def torn(rng: np.random.Generator, folder: Path) -> Case:
    """Make a case with lost, moved or overwritten parts."""
    name, log = _any(rng)
    way = damage.ROUGH[rng.integers(len(damage.ROUGH))]
    data, change = way(rng, log.data)
    (folder / "log.h5").write_bytes(data)
    return case_of("raw log, torn", f"{name}: {change}", log)


def altered(rng: np.random.Generator, folder: Path) -> Case:
    """Make a case with a log that a program wrote or changed through the library."""
    name, log = _any(rng)
    path = folder / "log.h5"
    path.write_bytes(log.data)
    change, plausible = hdf5_changes.change(rng, path)
    found, attributes = content(path)
    there = log._replace(
        channels={key: _as_read(found[key]) for key in log.channels if key in found},
        attributes={key: attributes[key] for key in log.attributes if key in attributes},
    )
    return case_of("raw log, other content", f"{name}: {change}", there if plausible else None)


def _any(rng: np.random.Generator) -> tuple[str, Log]:
    name = str(rng.choice(list(logs())))
    return name, logs()[name]


def case_of(kind: str, what: str, truth: Log | None) -> Case:
    """Return the check of a log; ``truth`` is its expected content, None if it is invalid."""

    def checked(folder: Path, ended: Ended) -> Verdict:
        return _compare(folder / "log.h5", truth, ended.code == 1)

    step = Step(("log", "check", "log.h5"), "fprc log check", ("log.h5",), checked, (), usable)
    return Case(kind, what, [step])


def usable(ended: Ended) -> bool:
    """Return whether a check accepted the file as a log, clean or not."""
    return ended.code in (0, 1) and "error:" not in ended.err


def _compare(path: Path, truth: Log | None, warned: bool) -> Verdict:
    if truth is None:
        return (SAID, "") if warned else (SILENT, "an error is not reported")
    other = _others(*content(path), truth)
    if not other:
        return SAME, ""
    return (SAID if warned else SILENT), f"differ: {', '.join(other)}"


def _others(channels: Mapping, attributes: Mapping, log: Log) -> list[str]:
    # the log may have additional content; only what was written is compared
    found = {name: _as_read(channels[name]) for name in log.channels if name in channels}
    kept = {name: attributes[name] for name in log.attributes if name in attributes}
    return differing(found, log.channels) + differing(kept, log.attributes)


def _as_read(values: np.ndarray) -> np.ndarray:
    return values.astype(np.float64) if values.dtype.kind in "fiu" else values
