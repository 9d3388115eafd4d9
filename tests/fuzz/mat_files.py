"""Recordings as MATLAB files, version 5 and 7.3, and as HDF5 files."""

import io
import tempfile
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import damage
import h5py
import imports
import numpy as np
import scipy.io
import signals
from judging import Case

#: Name of the variable for each channel.
_VARIABLES = {"theta_deg": "angle", "p_exp_kpa": "p", "p_o_kpa": "z"}
_KINDS = ("v5", "v5 compressed", "v5 struct", "v7.3", "HDF5", "HDF5 compressed")


@cache
def _arrays() -> dict[str, np.ndarray]:
    channels = signals.hysteresis(300)
    found = {"t": channels["time_s"]}
    return found | {name: channels[channel] for channel, name in _VARIABLES.items()}


def case(rng: np.random.Generator, folder: Path) -> Case:
    """Make a case with a binary recording and a map."""
    kind = _KINDS[rng.integers(len(_KINDS))]
    arrays: dict[str, Any] = dict(_arrays())
    done = []
    if rng.random() < 0.5:
        done.append(_CHANGES[rng.integers(len(_CHANGES))](rng, arrays))
    data = _write(kind, arrays)
    if rng.random() < 0.6:
        ways = (damage.flip, damage.flip, damage.flip, damage.flip, *damage.ROUGH)
        data, what = ways[rng.integers(len(ways))](rng, data)
        done.append(what)
    elif not kind.startswith("v5") and rng.random() < 0.2:
        data, what = _promise(rng, kind)
        done.append(what)
    name = "arm.mat" if kind.startswith("v") else "arm.h5"
    (folder / name).write_bytes(data)
    prefix = "run." if kind == "v5 struct" else ""
    mapping = imports.any_map(
        rng, {channel: prefix + column for channel, column in _VARIABLES.items()},
        {"column": f"{prefix}t", "unit": "s"}, signals.RATE_HZ,
    )  # fmt: skip
    if rng.random() < 0.15:
        done.append(f"map: {imports.spoil(rng, mapping)}")
    imports.write_map(folder, mapping)

    def read(path: Path) -> Mapping[str, np.ndarray | None]:
        return _read(path, kind)

    text = f"{kind}: {'; '.join(done) or 'as it should be'}"
    label = "recording, MATLAB 5" if kind.startswith("v5") else "recording, HDF5 and MATLAB 7.3"
    return Case(label, text, imports.steps(rng, name, mapping, read, draw=0.4), sound=not done)


def _write(kind: str, arrays: Mapping[str, Any]) -> bytes:
    if kind.startswith("v5"):
        arrays = {name: values for name, values in arrays.items() if values is not None}
        content = {"run": arrays} if kind == "v5 struct" else arrays
        file = io.BytesIO()
        scipy.io.savemat(file, content, do_compression="compressed" in kind, oned_as="column")
        return _without_date(file.getvalue())
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "arm")
        with h5py.File(path, "w", userblock_size=_front(kind)) as file:
            for name, values in arrays.items():
                _put(file, name, values, kind)
        return _named(path.read_bytes(), kind)


def _front(kind: str) -> int:
    """Return how many bytes of an HDF5 file are left to the program that writes it."""
    return 512 if kind == "v7.3" else 0


def _named(data: bytes, kind: str) -> bytes:
    mine = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
    return mine.ljust(512, b"\0") + data[512:] if kind == "v7.3" else data


def _without_date(data: bytes) -> bytes:
    return b"MATLAB 5.0 MAT-file".ljust(116) + data[116:]


def _put(file: h5py.File, name: str, values: Any, kind: str) -> None:
    if isinstance(values, dict):
        for key, inner in values.items():
            _put(file, f"{name}/{key}", inner, kind)
        return
    if isinstance(values, (list, str)):
        values = np.frombuffer(str(values).encode("utf-16-le"), np.uint16)
    if values is None:
        file[name] = h5py.Empty("f8")
        return
    values = np.asarray(values)
    if values.dtype.kind in "OU":
        values = np.arange(3.0)
    if values.dtype.kind == "c":
        values = np.rec.fromarrays([values.real, values.imag], names="real,imag")
    if kind == "v7.3" and values.ndim == 1:
        values = values[None, :]
    more = {"compression": "gzip"} if "compressed" in kind and values.size > 1 else {}
    dataset = file.create_dataset(name, data=values, **more)
    if kind == "v7.3":
        dataset.attrs["MATLAB_class"] = np.bytes_("double")


def _promise(rng: np.random.Generator, kind: str) -> tuple[bytes, str]:
    """Return a file that declares more samples than it has."""
    samples = int(rng.choice([10**7, 10**8, 10**9, 10**12]))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "arm")
        with h5py.File(path, "w", userblock_size=_front(kind)) as file:
            for name in _arrays():
                file.create_dataset(name, (samples,), "f8", chunks=(2**18,), compression="gzip")
        return _named(path.read_bytes(), kind), f"{samples:.0e} samples declared"


def _read(path: Path, kind: str) -> Mapping[str, np.ndarray | None]:
    """Return the variables, read one by one by the library."""
    found: dict[str, np.ndarray | None] = {}
    if kind.startswith("v5"):
        names = "run" if kind == "v5 struct" else list(_arrays())
        content = scipy.io.loadmat(path, variable_names=names, squeeze_me=True)
        if kind != "v5 struct":
            return {name: _flat(content.get(name)) for name in _arrays()}
        struct = content["run"]
        for name in _arrays():
            inside = struct.dtype.names and name in struct.dtype.names
            found[f"run.{name}"] = _flat(struct[name][()]) if inside else None
        return found
    with h5py.File(path, "r") as file:
        for name in _arrays():
            dataset = file.get(name)
            there = isinstance(dataset, h5py.Dataset)
            found[name] = _flat(dataset[()]) if there else None
    return found


def _flat(values: Any) -> np.ndarray | None:
    values = np.squeeze(np.asarray(values))
    return values if values.dtype.kind in "fiub" and values.ndim == 1 else None


# --- variants of the content ----------------------------------------------------------------


def _more(rng, arrays):
    odd = [
        np.empty((0, 0)), "text", ["a", 5], np.zeros((3, 3, 3)), np.arange(300) * 1j, 5.0, {},
        np.array([True, False]), np.array([], float), {"a": {"b": np.arange(3.0)}}, np.arange(300),
        np.array([{"y": 1.0}, {"y": 2.0}], object), np.zeros((300, 2)), np.full(300, np.nan),
        np.array([{"y": np.arange(300.0)}, {"y": np.arange(300.0)}], object),
        np.zeros(300, [("a", "f8"), ("b", "f8")]), np.empty(0, [("a", "f8")]), None,
    ]  # fmt: skip
    k = int(rng.integers(len(odd)))
    # MATLAB's names
    arrays["more"] = odd[k]
    return f"a variable more, {k}"


def _odd_values(rng, arrays):
    name = str(rng.choice(sorted(_arrays())))
    values = arrays[name].copy()
    values[int(rng.integers(len(values)))] = rng.choice([np.nan, np.inf, 1e308, -1e30])
    arrays[name] = values
    return f"an odd value in {name}"


def _clock(rng, arrays):
    values, way = arrays["t"].copy(), int(rng.integers(5))
    k = int(rng.integers(1, len(values)))
    if way == 0:
        values[k] = values[k - 1]
    elif way == 1:
        values[k:] += float(rng.choice([0.5, 1e6, 1e9]))
    elif way == 2:
        values *= float(rng.choice([1e6, 1e-6, 1e3]))
    elif way == 3:
        values = values[::-1]
    else:
        values += 1.7e9
    arrays["t"] = values
    return f"clock, way {way} at {k}"


def _shape(rng, arrays):
    name, way = str(rng.choice(sorted(_arrays()))), int(rng.integers(6))
    values = arrays[name]
    ways: list[Callable] = [
        lambda: values[:-1], lambda: values.reshape(2, -1), lambda: values.astype(np.float32),
        lambda: values[:0], lambda: values.astype(np.int16), lambda: values.reshape(1, -1, 1),
    ]  # fmt: skip
    arrays[name] = ways[way]()
    return f"shape of {name}, way {way}"


def _gone(rng, arrays):
    name = str(rng.choice(sorted(_arrays())))
    del arrays[name]
    return f"no {name}"


def _huge(rng, arrays):
    name = str(rng.choice(["angle", "p", "z"]))
    arrays[name] = arrays[name] * float(rng.choice([1e10, 1e200, 1e300, 1e-300, 0.0]))
    return f"{name} huge, tiny or 0"


_CHANGES = (_more, _more, _odd_values, _clock, _shape, _gone, _huge)
