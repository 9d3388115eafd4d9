"""Files of fitted models: damaged, or changed by somebody who also renewed the checksum.

A file whose checksum is wrong must be refused by every command. One with a renewed checksum is
refused too, or holds another whole model, whose steps are its predictions.
"""

import json
import shutil
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import damage
import h5py
import numpy as np
import raw_logs
import signals
from judging import SAID, SAME, SILENT, Case, Ended, Step, Verdict

from fprc.apparatus.programme import plan
from fprc.channels import Readings
from fprc.config import Settings
from fprc.errors import ControlError, FprcError
from fprc.models import (
    ESN,
    FPRC,
    NVAR,
    FeatureModel,
    FuzzyLinear,
    LowpassBank,
    PlayOperators,
    RidgeReadout,
    SideBySide,
    load_model,
    save_model,
)
from fprc.models.model_file import sealed

NAME, LOG, OUT, HEADER = "model.h5", "log.h5", "out.csv", "pff.h"

_BLOCK = 512
_MAPS = [
    ("plays", PlayOperators(n_plays=3), [0]),
    ("nvar", NVAR(n_taps=2, spacing=3), None),
    ("bank", LowpassBank((1.0, 0.1)), [1, 0]),
]
#: Models by name, and their columns.
_MODELS = {
    "fprc": (FPRC(n_c=3, random_state=1), 2),
    "fuzzy_linear": (FuzzyLinear(n_c=2, random_state=1), 1),
    "esn": (ESN(r=9, washout=5, random_state=1), 1),
    "maps": (FeatureModel(SideBySide(_MAPS), RidgeReadout()), 2),
}
#: The run of the rig, which takes the first of them.
_RUN = "track_sine_0p2_fprc"
_NOW = Readings(0.0, 1.0, 20.0, 2.0, 100.0, 0.0)

#: What replaces a value of the description.
_ODD: tuple[Any, ...] = (
    None, True, 0, -1, 1, 2, 3, 4, 7, 50, 4000, 10**5, 10**9, 10**30, -0.0, 0.5, 1.5, 1e-300, 1e12,
    1e308, "", "x", "3", "FPRC", "SequenceModel", "BaseEstimator", "RidgeReadout", [], {}, [1],
    [0.5], [[0.5]], ["a", "b"], [["a", 3, None]], {"array": "x"}, float("nan"), float("inf"),
    {"class": "FPRC", "parameters": {}}, {"class": "TapFeatures", "parameters": {"n_y": 10**9}},
    "__class__", "é\n\x1b[2J",
)  # fmt: skip
_PARAMETERS = {
    "n_c": (1, 2, 1000, 10**9), "n_y": (1, 6, 10**4, 10**9), "n_u": (1, 10**4, 10**9),
    "r": (1, 8, 4000, 10**9), "washout": (0, 7, 10**4, 10**9), "n_plays": (1, 10**4, 10**9),
    "spacing": (1, 20, 10**9), "degree": (3, 10, 10**9), "n_taps": (1, 1000, 10**9),
    "epsilon": (1e-300, 0.5, 1.0, 2.0), "sigma": (1e-300, 1e-9, 0.5, 1e9, 1e300),
    "gamma": (0.0, 0.999, 1.0), "rho": (0.0, 1e300), "alpha": (0.0, -1.0, 1e300),
    "random_state": (None, 7, -1, "x"), "n_references": (0, None, 7), "restarts": (3, 10**9),
    "epsilons": ([0.5, 0.1], [0.5] * 3, [0.5] * 10**6, [], [0]), "n_features_in_": (1, 3, 10**9),
}  # fmt: skip


class Model(NamedTuple):
    """A model file, its inputs, and what the model gives for them."""

    data: bytes
    X: np.ndarray
    output: np.ndarray


@cache
def models() -> dict[str, Model]:
    """Return a whole file of each model."""
    log = signals.hysteresis()
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, (model, columns) in _MODELS.items():
            X = np.column_stack([log["theta_deg"], log["p_o_kpa"]])[:, :columns]
            save_model(model.fit(X, log["p_exp_command_kpa"]), Path(folder, NAME))
            found[name] = Model(Path(folder, NAME).read_bytes(), X, model.predict(X))
    return found


def case(rng: np.random.Generator, folder: Path) -> Case:
    """Make a case of a changed model file."""
    name = str(rng.choice(list(_MODELS), p=(0.4, 0.2, 0.2, 0.2)))
    whole, path = models()[name], folder / NAME
    renewed = rng.random() < 0.6
    if rng.random() < (0.15 if renewed else 0.6):
        data, what = _damaged(rng, whole.data[_BLOCK:] if renewed else whole.data)
    else:
        path.write_bytes(whole.data)
        what = _change(rng, path)
        data = path.read_bytes()[_BLOCK if renewed else 0 :]
    path.write_bytes(sealed(data) if renewed else data)
    (folder / LOG).write_bytes(raw_logs.logs()["sweep"].data)
    kind = f"model, {'checksum renewed' if renewed else 'changed'}"
    return Case(kind, f"{name}: {what}", _steps(whole, path.read_bytes(), renewed))


def _steps(whole: Model, written: bytes, renewed: bool) -> list[Step]:
    def verdict(same: bool, problem: str = "") -> Verdict:
        if problem:
            return SILENT, problem
        if written != whole.data and not renewed:
            return SILENT, "accepted with a wrong checksum"
        return (SAME, "") if same or written == whole.data else (SAID, "another model")

    def used(folder: Path, ended: Ended) -> Verdict:
        model = load_model(folder / NAME)
        X = np.random.default_rng(1).uniform(0.0, 100.0, (60, model.n_features_in_))
        output, steps = model.predict(X), np.array([model.step(x) for x in X])
        if not np.isfinite([output, steps]).all():
            return verdict(False, "gives NaN or infinity")
        if np.abs(steps - output).max() > 1e-6 * np.abs(output).max() + 1e-6:
            return verdict(False, f"steps differ by {np.abs(steps - output).max()}")
        same = X.shape[1] == whole.X.shape[1] and np.array_equal(
            model.predict(whole.X), whole.output
        )
        return verdict(same)

    def predicted(folder: Path, ended: Ended) -> Verdict:
        output = np.loadtxt(folder / OUT, delimiter=",", skiprows=1)[:, -1]
        (folder / OUT).unlink()
        finite = np.isfinite(output).all()
        return verdict(np.array_equal(output, whole.output), "" if finite else "NaN in the table")

    def exported(folder: Path, ended: Ended) -> Verdict:
        text = (folder / HEADER).read_text()
        (folder / HEADER).unlink()
        return verdict(False, _compiler_says(text))

    def planned(folder: Path, ended: Ended) -> Verdict:
        law = plan(_RUN, Settings().model_dump(mode="json"), str(folder / NAME)).law
        try:
            finite = all(np.isfinite(law(k, _NOW)).all() for k in range(20))
        except ControlError:  # P_ff is not finite, which stops the run
            return verdict(False)
        return verdict(False, "" if finite else "commands NaN")

    return [
        Step((NAME,), "fprc.models", (NAME,), used, call=_use),
        Step(("predict", NAME, LOG, "--out", OUT), "fprc predict", (NAME,), predicted, (OUT,)),
        Step(("export", NAME, "--c", HEADER), "fprc export", (NAME,), exported, (HEADER,)),
        Step(
            ("rig", "run", _RUN, "--model", NAME), "fprc rig run", (NAME,), planned,
            accepts=lambda ended: "not armed, nothing was moved" in ended.err,
        ),
    ]  # fmt: skip


def _use(command: tuple[str, ...]) -> int:
    """Load a model, predict and step, as a program does."""
    try:
        model = load_model(command[0])
    except FprcError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    X = np.zeros((10**4, model.n_features_in_))
    model.predict(X)
    model.step(X[0])
    return 0


@cache
def _compiler() -> str | None:
    return shutil.which("cc")


def _compiler_says(header: str) -> str:
    """Return what a strict compiler says about a header; nothing without a compiler."""
    if _compiler() is None:
        return ""
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-x", "c", "-"]
    use = f"{header}\nint main(void) {{ pff_state s; pff_init(&s); return 0; }}\n"
    done = subprocess.run(["cc", *flags], input=use, capture_output=True, text=True, check=False)
    return done.stderr[:300]


# --- changes ----------------------------------------------------------------------------------


def _damaged(rng: np.random.Generator, data: bytes) -> tuple[bytes, str]:
    if rng.random() < 0.7:
        return damage.flip(rng, data)
    return damage.ROUGH[rng.integers(len(damage.ROUGH))](rng, data)


def _change(rng: np.random.Generator, path: Path) -> str:
    ways = (_array, _array, _place, _node, _node, _node, _parameter, _parameter, _text)
    with h5py.File(path, "a") as file:
        return ways[rng.integers(len(ways))](rng, file)


def _any_array(rng: np.random.Generator, file: h5py.File) -> str:
    return str(rng.choice([name for name in file if name != "model"]))


def _array(rng: np.random.Generator, file: h5py.File) -> str:
    name = _any_array(rng, file)
    values = file[name][()]
    flat = values.copy().reshape(-1)
    k = int(rng.integers(flat.size))
    flat[k] = rng.choice([np.nan, np.inf, -np.inf, 0.0, 7.0, -1e30, 1e31, 1e300, 5e-324])
    with np.errstate(all="ignore"):
        made = [
            flat.reshape(values.shape), flat.reshape(values.shape), values[:-1], values[..., :-1],
            values[..., :3], values[:0], values[:1], values.T, values.reshape(-1), values[None],
            np.repeat(values, 2, axis=0), values.sum(), values.astype("f4"), values.astype(">f8"),
            values.astype("f2"), values.astype("i8"), values > 0, values + 1j, values.astype("S8"),
            values * 1e20, values * 1e300, values * 0.0, -values, rng.permutation(flat),
            1.01 * values, rng.permutation(values), np.zeros(3, [("a", "f8")]),
        ]  # fmt: skip
    at = int(rng.integers(len(made)))
    del file[name]
    file[name] = made[at]
    return f"{name}, way {at}"


def _place(rng: np.random.Generator, file: h5py.File) -> str:
    name = str(rng.choice(list(file)))
    values = np.atleast_1d(file[name][()])
    shape, at = values.shape, int(rng.integers(12))
    other = _any_array(rng, file)
    if at < 10:
        del file[name]
    if at == 0:
        file[name] = h5py.ExternalLink("other.h5", f"/{name}")
    elif at == 1:
        file[name] = h5py.ExternalLink(LOG, "/theta_deg")
    elif at == 2:
        file[name] = h5py.SoftLink(f"/{other}")
    elif at == 3 and other in file:
        file[name] = file[other]  # one array under two names
    elif at == 4:
        file.create_group(name)
    elif at == 5:
        layout = h5py.VirtualLayout(shape, "f8")
        layout[:] = h5py.VirtualSource(LOG, "theta_deg", shape)
        file.create_virtual_dataset(name, layout)
    elif at == 6:
        file.create_dataset(name, shape, "f8", external=[(LOG, 0, 8 * max(values.size, 1))])
    elif at == 7:
        file.create_dataset(name, data=values, chunks=True, compression="gzip", shuffle=True)
    elif at == 8:
        size = int(rng.choice([10**6, 10**9, 10**15]))
        file.create_dataset(name, (size,), "f8", chunks=(2**16,) if rng.random() < 0.5 else None)
    elif at == 10:
        file[f"more{rng.integers(9)}_"] = np.ones(3)
    elif at == 11:
        file.attrs["remark"] = "x" * 100  # not read
    return f"{name} elsewhere, way {at}"


def _write_text(file: h5py.File, text: bytes) -> None:
    del file["model"]
    file["model"] = np.bytes_(text)


def _write(file: h5py.File, described: Any) -> None:
    _write_text(file, json.dumps(described).encode())


def _described(file: h5py.File) -> Any:
    return json.loads(file["model"][()])


def _nodes(value: Any) -> list[tuple[Any, Any]]:
    """Return every container and key in a description."""
    if not isinstance(value, dict | list):
        return []
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    return [pair for key, each in inner for pair in [(value, key), *_nodes(each)]]


def _node(rng: np.random.Generator, file: h5py.File) -> str:
    """Change one or two values of the description, wherever they are."""
    described, changed = _described(file), []
    for _ in range(int(rng.choice([1, 1, 2]))):
        nodes = _nodes(described)
        inner, key = nodes[rng.integers(len(nodes))]
        odd = _ODD[rng.integers(len(_ODD))]
        way = rng.random()
        if way < 0.7:
            inner[key] = odd
        elif way < 0.85:
            inner.pop(key)
            odd = "gone"
        elif isinstance(inner, dict):
            inner[str(rng.choice(["more", "more_", "__init__", "fit_", "array", "class"]))] = odd
        else:
            inner.append(odd)
        changed.append(f"{key} = {str(odd)[:40]!r}")
    _write(file, described)
    return ", ".join(changed)


def _parameter(rng: np.random.Generator, file: h5py.File) -> str:
    """Change a parameter in the model and in every part that has it."""
    described = _described(file)
    nodes = _nodes(described)
    names = sorted({key for _, key in nodes if key in _PARAMETERS})
    name = str(rng.choice(names))
    odd = _PARAMETERS[name][rng.integers(len(_PARAMETERS[name]))]
    for inner, key in nodes:
        if key == name:
            inner[key] = odd
    _write(file, described)
    return f"every {name} = {str(odd)[:40]}"


def _text(rng: np.random.Generator, file: h5py.File) -> str:
    text = file["model"][()]
    made = [
        b"", b"{}", b"[]", b"5", b"null", text[:-1], text + b"x", text * 2, b"[" * 10**6,
        b'{"a":' * 10**5, text.replace(b"1", b"9" * 5000), text.replace(b"FPRC", b"\xff\xfe"),
        b" " * 10**7 + text, b"\xef\xbb\xbf" + text, text.decode().encode("utf-16"),
    ]  # fmt: skip
    way = int(rng.integers(len(made) + 2))
    if way < len(made):
        _write_text(file, made[way])
    elif way == len(made):
        del file["model"]
        file["model"] = text.decode()  # of variable length
    else:
        del file["model"]
        file["model"] = np.frombuffer(text, np.uint8)
    return f"text, way {way}"
