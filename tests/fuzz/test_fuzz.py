"""Damaged and odd files: every command refuses them with a message, or reads what was written.

`.ci/weekly` draws more of them, and others in each run.
"""

import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
from copy import deepcopy
from functools import cache
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest
import scipy.io
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fprc.apparatus.journal import Journal
from fprc.apparatus.programme import plan
from fprc.channels import RAW_CHANNELS, Readings
from fprc.config import Settings
from fprc.errors import ControlError, FprcError
from fprc.logs import write_raw
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
from fprc.models.storage import sealed

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits memory as Linux does"),
]

_ASKED = os.environ.get("FPRC_EXAMPLES")
FUZZ = settings(
    max_examples=int(_ASKED or "6"), deadline=None, derandomize=not _ASKED,
    suppress_health_check=list(HealthCheck),
)  # fmt: skip
SPECIAL = b'"|,|;|\n|\r|\0|\xff|\xef\xbb\xbf|\x1b[2J|#|\t|e|-|.|\xc2\x85|*|&|{'.split(b"|")


@st.composite
def damaged(draw, data, places=None):
    """Draw damage to some bytes: at one of the places, or anywhere.

    Bit errors, bytes that are special in text, and stretches that are cut off, blank, noise,
    taken out, repeated or exchanged, as disks and editors leave them.
    """
    noise = random.Random(draw(st.integers(0, 2**32)))
    size = min(1 << draw(st.integers(0, 12)), max(len(data) // 2, 1))
    at, to = sorted(draw(st.integers(0, max(len(data) - size, 0))) for _ in range(2))
    end = at + size
    flipped = bytearray(data)
    for _ in range(draw(st.integers(1, 3))):
        where = noise.choice(places) if places is not None else noise.randrange(len(data))
        flipped[where] ^= 1 << noise.randrange(8) if noise.random() < 0.5 else 255
    ways = [
        bytes(flipped),
        data[:at] + noise.choice(SPECIAL) + data[at:],
        data[:at],
        data + noise.choice([data, noise.randbytes(size)]),
        data[:at] + bytes(size) + data[end:],
        data[:at] + noise.randbytes(size) + data[end:],
        data[:at] + data[end:],
        data[:end] + data[at:],
        data[:at] + data[to : to + size] + data[end:to] + data[at:end] + data[to + size :]
        if end <= to
        else data[:at],
    ]
    return draw(st.sampled_from(ways if places is None else ways[:1]))


def signals(samples=300):
    """Return every channel of a raw log."""
    time_s, noise = np.arange(samples) / 200.0, np.random.default_rng(7)
    wave = 30.0 - 25.0 * np.cos(5.0 * time_s)
    channels = {name: wave + 1e-3 * noise.standard_normal(samples) for name in RAW_CHANNELS}
    return channels | {"time_s": time_s}


DESCRIBED = {"experiment": "sweep", "source": "rig", "sample_rate_hz": 200.0, "seed": 1,
             "software": "fprc test", "rig": {"control": {"k_in_kpa_per_deg": 7.0}}}  # fmt: skip


def written(name, write):
    """Return the bytes that a function writes to a path of this name."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, name)
        write(path)
        return path.read_bytes()


# --- raw logs and journals --------------------------------------------------------------------


@cache
def raw_log():
    """Return a raw log, and where its samples and its other bytes are."""
    data = written("log.h5", lambda path: write_raw(path, signals(), **DESCRIBED))
    numbers = np.zeros(len(data), bool)
    with tempfile.NamedTemporaryFile(suffix=".h5") as file:
        file.write(data)
        file.flush()
        with h5py.File(file.name) as log:
            for dataset in log.values():
                chunk = dataset.id.get_chunk_info(0)
                numbers[chunk.byte_offset : chunk.byte_offset + chunk.size] = True
    used = np.frombuffer(data, np.uint8) != 0
    return data, [np.flatnonzero(numbers).tolist(), np.flatnonzero(~numbers & used).tolist(), None]


def content(path):
    """Return channels and attributes of an HDF5 file, read by h5py alone."""
    with h5py.File(path, "r") as file:
        channels = {name: (file[name][()].tobytes(), file[name].attrs["units"]) for name in file}
        return channels, {name: file.attrs.get(name) for name in DESCRIBED}


@FUZZ
@given(st.data())
def test_log_is_refused_or_is_the_one_that_was_written(bench, draw):
    data, places = raw_log()
    bench.put(log_h5=data)
    expected = content(bench.folder / "log.h5")
    bench.put(log_h5=draw.draw(damaged(data, draw.draw(st.sampled_from(places)))))

    def usable(ended):
        return ended.code in (0, 1) and "error:" not in ended.out

    if bench.run("log", "check", "log.h5", names=["log.h5"], accepted=usable):
        assert content(bench.folder / "log.h5") == expected


@cache
def journal(close=True, seed=0):
    """Return a journal of a run that was closed or killed."""
    rows = np.column_stack([*signals().values()]) + seed

    def write(path):
        kept = Journal(path, tuple(signals(2)), DESCRIBED | {"seed": seed})
        for tick, row in enumerate(rows.tolist()):
            kept.append(tick + (tick > 100), row)  # one missed tick
        data = path.read_bytes()
        kept.close()
        if not close:
            path.write_bytes(data)

    return written("run.journal", write)


@FUZZ
@given(st.data())
def test_journal_gives_samples_that_were_written_in_their_order(bench, draw):
    whole, other = journal(draw.draw(st.booleans())), journal(seed=1)
    if draw.draw(st.integers(0, 4)):
        data = draw.draw(damaged(whole))
    else:  # pages of another run, as a disk may return after a power cut
        header = whole.index(b"\n", 8) + 1
        at, size = (draw.draw(st.integers(header, len(whole))) for _ in range(2))
        data = whole[:at] + other[at : at + size] + whole[at + size :]
    bench.put(run_journal=data)
    ended = bench.run(
        "log", "repair", "run.journal", "--out", "run.h5", names=["run.journal"],
        writes=["run.h5"], accepted=lambda ended: ended.code in (0, 3),
    )  # fmt: skip
    if ended is None:
        assert data != whole
        return
    with h5py.File(bench.folder / "run.h5") as file:
        found = np.column_stack([file[name][()] for name in signals(2)])
        assert json.loads(file.attrs["rig"]) == DESCRIBED["rig"]
    place = {row.tobytes(): k for k, row in enumerate(np.column_stack([*signals().values()]))}
    places = [place[row.tobytes()] for row in np.ascontiguousarray(found)]
    assert places == sorted(set(places))
    assert ended.code == 3 or len(found) == len(place)


# --- recordings of other programs -------------------------------------------------------------

COLUMNS = {"t": "time_s", "angle": "theta_deg", "p": "p_exp_kpa", "z": "p_o_kpa"}
CHANNELS = {
    channel: {"column": column, "unit": "kPa" if "kpa" in channel else "deg"}
    for column, channel in COLUMNS.items()
    if column != "t"
}
MAP = {"experiment": "sweep", "time": {"column": "t"}, "channels": CHANNELS}


@cache
def recording(kind):
    table = pd.DataFrame({name: signals()[channel] for name, channel in COLUMNS.items()})
    writers = {
        "csv": lambda path: table.to_csv(path, index=False),
        "mat": lambda path: scipy.io.savemat(path, dict(table.items()), do_compression=True),
        "npz": lambda path: np.savez_compressed(path, **dict(table.items())),
        "xlsx": lambda path: table.to_excel(path, index=False),
    }
    return written(f"arm.{kind}", writers[kind])


@FUZZ
@given(st.data())
def test_recording_is_refused_or_imported_in_numbers(bench, draw):
    kind = draw.draw(st.sampled_from(["csv", "csv", "mat", "npz", "xlsx"]))
    data, name = draw.draw(damaged(recording(kind))), f"arm.{kind}"
    bench.put(**{f"arm_{kind}": data}, map_yaml=yaml.safe_dump(MAP).encode())
    bench.run("import", name, "--draft", names=[name])
    command = ("import", name, "--map", "map.yaml", "--out", "out.h5")
    if bench.run(*command, names=[name, "map.yaml"], writes=["out.h5", "out.png"]):
        with h5py.File(bench.folder / "out.h5") as file:
            found = np.array([file[key][()] for key in file])
        assert np.isfinite(found).all()


# --- models -----------------------------------------------------------------------------------

#: Bytes before the HDF5 part of a model file: checksum and format.
BLOCK = 512
RUN, NOW = "track_sine_0p2_fprc", Readings(0.0, 1.0, 20.0, 2.0, 100.0, 0.0)

#: What replaces a value of a model's description.
ODD_VALUES = (
    None, True, 0, -1, 1, 2, 3, 50, 4000, 10**5, 10**9, 10**30, -0.0, 0.5, 1e-300, 1e12, 1e308, "",
    "x", "FPRC", "SequenceModel", "BaseEstimator", "RidgeReadout", [], {}, [1], [[0.5]], ["a"],
    [["a", 3, None]], {"array": "x"}, float("nan"), float("inf"), "__class__", "é\n\x1b[2J",
    {"class": "FPRC", "parameters": {}}, {"class": "TapFeatures", "parameters": {"n_y": 10**9}},
)  # fmt: skip


@cache
def model(name):
    """Return the file of a fitted model."""
    maps = [
        (PlayOperators(n_plays=3), [0]),
        (NVAR(n_taps=2, spacing=3), [0, 1]),
        (LowpassBank((1.0, 0.1)), [1, 0]),
    ]
    made, columns = {
        "fprc": (FPRC(n_c=3, random_state=1), 2),
        "fuzzy_linear": (FuzzyLinear(n_c=2, random_state=1), 1),
        "esn": (ESN(r=9, washout=5, random_state=1), 1),
        "maps": (FeatureModel(SideBySide(maps), RidgeReadout()), 2),
    }[name]
    log = signals()
    X = np.column_stack([log["theta_deg"], log["p_o_kpa"]])[:, :columns]
    made.fit(X, log["p_exp_command_kpa"])
    return written("model.h5", lambda path: save_model(made, path))


def nodes(value):
    """Return every container and key in a description."""
    if not isinstance(value, dict | list):
        return []
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    return [pair for key, child in inner for pair in [(value, key), *nodes(child)]]


def change_description(file, draw):
    """Change, add or remove values of the description, one of them wherever its key occurs."""
    described = json.loads(file["model"][()])
    for _ in range(draw(st.integers(1, 2))):
        inner, key = draw(st.sampled_from(nodes(described)))
        # a copy: a later change may be one of the value, and other examples draw it too
        odd, way = deepcopy(draw(st.sampled_from(ODD_VALUES))), draw(st.integers(0, 5))
        if way == 0:
            inner.pop(key)
        elif way == 1 and isinstance(inner, dict):
            inner[draw(st.sampled_from(["more", "more_", "__init__", "fit_", "array"]))] = odd
        else:
            for holder, name in nodes(described) if way == 2 else [(inner, key)]:
                if name == key:
                    holder[name] = odd
    text = json.dumps(described).encode()
    odd = [text[:-1], text * 2, b"[" * 10**6, text.replace(b"1", b"9" * 5000), b"5"]
    text = draw(st.sampled_from([*odd, *8 * [text]]))
    del file["model"]
    file["model"] = text.decode() if draw(st.integers(0, 12)) == 5 else np.bytes_(text)


def change_array(file, draw):
    """Replace an array by another of other values, shape or type, or by a link."""
    name = draw(st.sampled_from([name for name in file if name != "model"]))
    values = np.atleast_1d(file[name][()])
    flat = values.astype(float).reshape(-1)
    odd = st.sampled_from([np.nan, np.inf, 0.0, 7.0, -1e30, 1e300, 5e-324])
    flat[draw(st.integers(0, flat.size - 1))] = draw(odd)
    with np.errstate(all="ignore"):
        made = [
            flat.reshape(values.shape), values[:-1], values[..., :-1], values[:0], values.T,
            values.reshape(-1), values[None], np.repeat(values, 2, axis=0), values.sum(),
            flat[0], values.astype("f4"), values.astype(">f8"), values.astype("i8"), values > 0,
            values + 1j, values.astype("S8"), values * 1e20, values * 1e300, -values,
            np.zeros(3, [("a", "f8")]), h5py.ExternalLink("log.h5", "/theta_deg"),
            h5py.SoftLink("/model"), h5py.ExternalLink("other.h5", f"/{name}"), None,
        ]  # fmt: skip
    change = draw(st.sampled_from(made))
    del file[name]
    if change is None:
        file.create_dataset(name, (draw(st.sampled_from([10**6, 10**15])),), "f8", chunks=(2**16,))
    else:
        file[name] = change


@FUZZ
@given(st.data())
def test_changed_model_is_refused_or_whole(bench, draw):
    """With a wrong checksum it is refused; with one that was renewed it may be another model."""
    data = model(draw.draw(st.sampled_from(["fprc", "fuzzy_linear", "esn", "maps"])))
    begin = BLOCK * (draw.draw(st.integers(0, 3)) > 0)  # then its checksum is renewed
    way = draw.draw(st.integers(0, 4))
    bench.put(model_h5=data, log_h5=raw_log()[0])
    if way == 0:
        changed = draw.draw(damaged(data[begin:]))
    else:
        with h5py.File(bench.folder / "model.h5", "a") as file:
            draw.draw(st.sampled_from([change_array, change_description]))(file, draw.draw)
        changed = (bench.folder / "model.h5").read_bytes()[begin:]
    changed = sealed(changed) if begin else changed
    bench.put(model_h5=changed, log_h5=raw_log()[0])
    try:
        loaded = load_model(bench.folder / "model.h5")
    except FprcError:  # the commands below must name the file
        loaded = None
    assert begin or loaded is None or changed == data
    if loaded is not None:
        X = np.random.default_rng(1).uniform(0.0, 100.0, (60, loaded.n_features_in_))
        output, steps = loaded.predict(X), np.array([loaded.step(x) for x in X])
        assert np.isfinite(output).all()
        assert np.abs(steps - output).max() <= 1e-6 * np.abs(output).max() + 1e-6
    check_commands(bench, loaded is not None)


def check_commands(bench, loads):
    """Run the commands that take a model; none accepts one that cannot be loaded."""

    def tried(*command, **more):
        ended = bench.run(*command, names=["model.h5"], **more)
        assert loads or ended is None
        return ended

    if tried("predict", "model.h5", "log.h5", "--out", "out.csv", writes=["out.csv"]):
        table = np.loadtxt(bench.folder / "out.csv", delimiter=",", skiprows=1)
        assert np.isfinite(table).all()
    if tried("export", "model.h5", "--c", "pff.h", writes=["pff.h"]) and shutil.which("cc"):
        use = '#include "pff.h"\nint main(void) { pff_state s; pff_init(&s); return 0; }\n'
        flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I", bench.folder]
        subprocess.run(["cc", *flags, "-x", "c", "-"], input=use, text=True, check=True)
    if tried("rig", "run", RUN, "--model", "model.h5",
             accepted=lambda ended: "not armed, nothing was moved" in ended.out):  # fmt: skip
        settings = Settings().model_dump(mode="json")
        law = plan(RUN, settings, str(bench.folder / "model.h5")).law
        try:
            assert all(np.isfinite(law(k, NOW)).all() for k in range(20))
        except ControlError:  # P_ff is not finite: the run stops
            pass
