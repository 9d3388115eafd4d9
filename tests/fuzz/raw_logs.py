"""Raw logs with damaged bytes, and with lost, moved or overwritten parts."""

import json
import tempfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import damage
import h5py
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
                chunk = dataset.id.get_chunk_info(0)
                numbers[chunk.byte_offset : chunk.byte_offset + chunk.size] = True
    names = {"simulated", "units", *_DESCRIBED, *attributes}
    kept = {name: value for name, value in stored.items() if name.rpartition(".")[2] in names}
    used = np.frombuffer(data, np.uint8) != 0  # most other bytes are free space
    return Log(data, found, kept, np.flatnonzero(numbers), np.flatnonzero(~numbers & used))


def content(path: Path) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Return the channels and attributes of a file, read by h5py alone."""
    channels, attributes = {}, {}
    with h5py.File(path, "r") as file:
        for name in file:
            channels[name] = file[name][()]
        for prefix, owner in {"": file, **{f"{name}.": file[name] for name in file}}.items():
            for name, value in owner.attrs.items():
                value = value.item() if isinstance(value, np.generic) else value
                attributes[prefix + name] = value.decode() if isinstance(value, bytes) else value
    return channels, attributes


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


def _any(rng: np.random.Generator) -> tuple[str, Log]:
    name = str(rng.choice(list(logs())))
    return name, logs()[name]


def case_of(kind: str, what: str, log: Log) -> Case:
    """Return the check of a log, which must find its content or say what is wrong."""

    def checked(folder: Path, ended: Ended) -> Verdict:
        channels, attributes = content(folder / "log.h5")
        kept = {name: attributes[name] for name in log.attributes if name in attributes}
        other = differing(channels, log.channels) + differing(kept, log.attributes)
        if not other:
            return SAME, ""
        return (SAID if ended.code == 1 else SILENT), f"differ: {', '.join(other)}"

    step = Step(("log", "check", "log.h5"), "fprc log check", ("log.h5",), checked, (), usable)
    return Case(kind, what, [step])


def usable(ended: Ended) -> bool:
    """Return whether a check accepted the file as a log, clean or not."""
    return ended.code in (0, 1) and "error:" not in ended.err
