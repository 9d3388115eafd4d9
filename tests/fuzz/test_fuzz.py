"""Damaged and odd files: every command refuses them with a message, or reads what was written.

`.ci/weekly` draws more of them, and others in each run.
"""

import json
import os
import random
import shutil
import string
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
from fprc.channels import Readings
from fprc.config import Settings
from fprc.config.section import fields
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

RATE_HZ = 200.0


@st.composite
def damaged(draw, data, places=None):
    """Draw damage to some bytes: at one of the places, or anywhere.

    Bit errors, bytes that are special in text, and stretches that are cut off, blank, noise,
    taken out, repeated or exchanged, as disks and editors leave them.
    """
    noise = random.Random(draw(st.integers(0, 2**32)))
    way = draw(st.sampled_from(["flip"] * 4 + ["insert", "cut", "append", "blank", "noise"]))
    way = draw(st.sampled_from([way, way, "drop", "repeat", "swap"])) if places is None else "flip"
    size = min(1 << draw(st.integers(0, 12)), max(len(data) // 2, 1))
    at, to = sorted(draw(st.integers(0, max(len(data) - size, 0))) for _ in range(2))
    end = at + size
    if way == "flip":
        changed = bytearray(data)
        for _ in range(draw(st.integers(1, 3))):
            where = noise.choice(places) if places is not None else noise.randrange(len(data))
            changed[where] ^= 1 << noise.randrange(8) if noise.random() < 0.5 else 255
        return bytes(changed)
    special = [b'"', b",", b";", b"\n", b"\r", b"\0", b"\xff", b"\xef\xbb\xbf", b"\x1b[2J", b"#",
               b"\t", b"e", b"-", b".", b"\xc2\x85", b"*", b"&", b"{"]  # fmt: skip
    return {
        "insert": lambda: data[:at] + noise.choice(special) + data[at:],
        "cut": lambda: data[:at],
        "append": lambda: data + noise.choice([data, noise.randbytes(size)]),
        "blank": lambda: data[:at] + bytes(size) + data[end:],
        "noise": lambda: data[:at] + noise.randbytes(size) + data[end:],
        "drop": lambda: data[:at] + data[end:],
        "repeat": lambda: data[:end] + data[at:],
        "swap": lambda: data[:at] + data[to : to + size] + data[end:to] + data[at:end]
        + data[to + size :] if end <= to else data[:at],
    }[way]()  # fmt: skip


def signals(samples=300):
    """Return every channel of a raw log that passes all quality checks."""
    rng = np.random.default_rng(7)
    time_s = np.arange(samples) / RATE_HZ
    p_exp = 175.0 - 120.0 * np.cos(2.0 * np.pi * 0.9 * time_s)
    theta = 60.0 * (p_exp / 350.0) ** 1.2 + 3.0 * np.sin(2.0 * np.pi * 0.9 * time_s)
    channels = {
        "p_exp_command_kpa": p_exp, "p_exp_kpa": p_exp, "theta_deg": theta,
        "p_i_command_kpa": 7.0 * theta, "p_i_kpa": 7.0 * theta,
        "p_o_kpa": 110.0 + theta + time_s / 60.0, "phi_deg": 0.5 * theta,
        "valve_main_v": 5.0 + np.gradient(p_exp) / 4.0,
        "valve_reservoir_v": 5.0 + np.gradient(theta),
    }  # fmt: skip
    noisy = {
        name: values if "command" in name else values + 1e-3 * rng.standard_normal(samples)
        for name, values in channels.items()
    }
    return {"time_s": time_s, **noisy}


DESCRIBED = {"experiment": "sweep", "source": "rig", "sample_rate_hz": RATE_HZ, "seed": 1,
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
        with h5py.File(file.name) as content:
            for dataset in content.values():
                chunk = dataset.id.get_chunk_info(0)
                numbers[chunk.byte_offset : chunk.byte_offset + chunk.size] = True
    used = np.frombuffer(data, np.uint8) != 0
    return data, [np.flatnonzero(numbers).tolist(), np.flatnonzero(~numbers & used).tolist(), None]


def content(path):
    """Return channels and attributes of an HDF5 file, read by h5py alone."""
    with h5py.File(path, "r") as file:
        attributes = {**file.attrs, **{f"{n}.units": file[n].attrs["units"] for n in file}}
        return (
            {name: file[name][()].tobytes() for name in file},
            {name: value for name, value in attributes.items() if name in KEPT},
        )


KEPT = {*DESCRIBED, *(f"{name}.units" for name in signals(2))}


@FUZZ
@given(st.data())
def test_log_is_refused_or_is_the_one_that_was_written(bench, draw):
    data, places = raw_log()
    bench.put(log_h5=data)
    expected = content(bench.folder / "log.h5")
    bench.put(log_h5=draw.draw(damaged(data, draw.draw(st.sampled_from(places)))))

    def usable(ended):
        return ended.code in (0, 1) and "error:" not in ended.err

    ended = bench.run("log", "check", "log.h5", names=["log.h5"], accepted=usable)
    if ended and ended.code == 0:
        assert content(bench.folder / "log.h5") == expected


@cache
def journals():
    """Return journals of a run that was closed, one that was killed, and another run."""

    def write(path, close, seed):
        attributes = DESCRIBED | {"seed": seed, "started": "2024-01-01T00:00:00.000000+00:00"}
        journal = Journal(path, tuple(signals(2)), attributes)
        for tick, row in enumerate((rows_of() + seed).tolist()):
            journal.append(tick + (tick > 100), row)  # one missed tick
        data = path.read_bytes()
        journal.close()
        if not close:
            path.write_bytes(data)

    runs = {"closed": (True, 0), "killed": (False, 0), "another": (True, 1)}
    return {
        name: written("run.journal", lambda path, how=how: write(path, *how))
        for name, how in runs.items()
    }


def rows_of():
    return np.column_stack([*signals().values()])


@FUZZ
@given(st.data())
def test_journal_gives_samples_that_were_written_in_their_order(bench, draw):
    kind = draw.draw(st.sampled_from(["closed", "killed"]))
    data, other = journals()[kind], journals()["another"]
    if draw.draw(st.integers(0, 4)):
        data = draw.draw(damaged(data))
    else:  # pages of another run, as a disk may return after a power cut
        header = data.index(b"\n", 8) + 1
        at, size = (draw.draw(st.integers(header, len(data))) for _ in range(2))
        data = data[:at] + other[at : at + size] + data[at + size :]
    bench.put(run_journal=data)
    ended = bench.run(
        "log", "repair", "run.journal", "--out", "run.h5", names=["run.journal"],
        writes=["run.h5"], accepted=lambda ended: ended.code in (0, 3),
    )  # fmt: skip
    if ended is None:
        assert data != journals()[kind]
        return
    with h5py.File(bench.folder / "run.h5") as file:
        found = np.column_stack([file[name][()] for name in signals(2)])
        assert json.loads(file.attrs["rig"]) == DESCRIBED["rig"]
    place = {row.tobytes(): k for k, row in enumerate(rows_of())}
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
    outputs = ("out.h5", "out.png")
    command = ("import", name, "--map", "map.yaml", "--out", "out.h5")
    if bench.run(*command, names=[name, "map.yaml"], writes=outputs):
        with h5py.File(bench.folder / "out.h5") as file:
            found = [file[key][()] for key in file]
        assert len(set(map(len, found))) == 1
        assert np.isfinite(found).all()


# --- configurations ---------------------------------------------------------------------------

#: Values that a person may write where a number, a name or a unit is due.
ODD = ("", " ", "nan", "inf", "1e400", "1,000", "1_0", "x", "\x1b[31m", "0x10", "1.2.3", "=1+1",
       "null", '"', "½", "٣", "9" * 400, "y" * 10**5, "\u2028", "$\\frac{$")  # fmt: skip
ODD_YAML = (
    *ODD, "010", "1:30", "0o17", "1e3", "+5", "-0", ".5", "'7'", ".nan", "-.inf", "1" * 5000,
    "true", "no", "~", "2020-01-01", "[]", "{}", "[1, 2]", "{a: 1}", "[[1]]", "{1: 2}", "*nothing",
    "!!python/object/apply:os.system [ls]", "!!binary aGFsbG8=", "&a [*a]", "|\n    text\n", "@x",
    "- 5", "sim", "${HOME}", "[" * 5000 + "]" * 5000,
)  # fmt: skip


@FUZZ
@given(st.data())
def test_configuration_is_refused_or_read_with_the_values_of_its_text(bench, draw):
    defaults = Settings().model_dump(mode="json")
    names = st.lists(st.sampled_from([name for name, *_ in fields(Settings)]), min_size=1)
    tree = {}
    for name in draw.draw(names):
        *way, last = name.split(".")
        inner, value = tree, defaults
        for part in way:
            inner, value = inner.setdefault(part, {}), value[part]
        inner[last] = "ODD" if draw.draw(st.integers(0, 3)) == 0 else value[last]
    text = yaml.safe_dump(tree, default_flow_style=draw.draw(st.sampled_from([True, False, None])))
    while "ODD" in text:
        text = text.replace("ODD", draw.draw(st.sampled_from(ODD_YAML)).replace("ODD", ""), 1)
    data = text.encode()
    data = draw.draw(damaged(data)) if draw.draw(st.booleans()) else data
    bench.put(mine_yaml=data)
    # a message names the file, or the key, which the damage may have changed
    words = data.decode("utf-8", "replace")
    for mark in string.whitespace + string.punctuation.replace("_", ""):
        words = words.replace(mark, " ")
    keys = [word for word in words.split() if len(word) > 2]
    bench.run("config", "check", "mine.yaml", names=["mine.yaml", *keys])


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
def models():
    """Return by name the file of a fitted model, and its inputs."""
    maps = [
        (PlayOperators(n_plays=3), [0]),
        (NVAR(n_taps=2, spacing=3), [0, 1]),
        (LowpassBank((1.0, 0.1)), [1, 0]),
    ]
    made = {
        "fprc": (FPRC(n_c=3, random_state=1), 2),
        "fuzzy_linear": (FuzzyLinear(n_c=2, random_state=1), 1),
        "esn": (ESN(r=9, washout=5, random_state=1), 1),
        "maps": (FeatureModel(SideBySide(maps), RidgeReadout()), 2),
    }
    log, found = signals(), {}
    for name, (model, columns) in made.items():
        X = np.column_stack([log["theta_deg"], log["p_o_kpa"]])[:, :columns]
        model.fit(X, log["p_exp_command_kpa"])
        found[name] = written("model.h5", lambda path, model=model: save_model(model, path)), X
    return found


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
        elif way == 2:
            for holder, name in nodes(described):
                if name == key:
                    holder[name] = odd
        else:
            inner[key] = odd
    text = json.dumps(described).encode()
    way = draw(st.integers(0, 12))
    text = [text[:-1], text * 2, b"[" * 10**6, text.replace(b"1", b"9" * 5000), b"5"][way] if (
        way < 5) else text  # fmt: skip
    del file["model"]
    file["model"] = text.decode() if way == 5 else np.bytes_(text)


def change_array(file, draw):
    """Replace an array by another of other values, shape or type, or by a link."""
    name = draw(st.sampled_from([name for name in file if name != "model"]))
    values = np.atleast_1d(file[name][()])
    flat = values.astype(float).reshape(-1)
    flat[draw(st.integers(0, flat.size - 1))] = draw(
        st.sampled_from([np.nan, np.inf, 0.0, 7.0, -1e30, 1e300, 5e-324])
    )
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


def compiler_says(header):
    """Return what a strict compiler says about a header; nothing without a compiler."""
    if shutil.which("cc") is None:
        return ""
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-x", "c", "-"]
    use = f"{header}\nint main(void) {{ pff_state s; pff_init(&s); return 0; }}\n"
    return subprocess.run(["cc", *flags], input=use, capture_output=True, text=True).stderr


@FUZZ
@given(st.data())
def test_changed_model_is_refused_or_whole(bench, draw):
    """With a wrong checksum it is refused; with one that was renewed it may be another model."""
    data, X = models()[draw.draw(st.sampled_from([*models()]))]
    renewed = draw.draw(st.integers(0, 3)) > 0
    way = draw.draw(st.integers(0, 5))
    if way == 0:
        changed = data[BLOCK:] if renewed else data
    elif way == 1:
        changed = draw.draw(damaged(data[BLOCK:] if renewed else data))
    else:
        bench.put(model_h5=data, log_h5=raw_log()[0])
        with h5py.File(bench.folder / "model.h5", "a") as file:
            draw.draw(st.sampled_from([change_array, change_description]))(file, draw.draw)
        changed = (bench.folder / "model.h5").read_bytes()[BLOCK if renewed else 0 :]
    changed = sealed(changed) if renewed else changed
    bench.put(model_h5=changed, log_h5=raw_log()[0])
    try:
        model = load_model(bench.folder / "model.h5")
    except FprcError:  # the commands below must name the file
        model = None
    assert renewed or model is None or changed == data
    if model is not None:
        X = np.random.default_rng(1).uniform(0.0, 100.0, (60, model.n_features_in_))
        output, steps = model.predict(X), np.array([model.step(x) for x in X])
        assert np.isfinite(output).all()
        assert np.abs(steps - output).max() <= 1e-6 * np.abs(output).max() + 1e-6
    check_commands(bench, model)


def check_commands(bench, model):
    """Run the commands that take a model; none accepts one that cannot be loaded."""
    ended = bench.run(
        "predict", "model.h5", "log.h5", "--out", "out.csv", names=["model.h5"], writes=["out.csv"]
    )
    assert model is not None or ended is None
    if ended:
        table = np.loadtxt(bench.folder / "out.csv", delimiter=",", skiprows=1)
        assert np.isfinite(table).all()
    ended = bench.run("export", "model.h5", "--c", "pff.h", names=["model.h5"], writes=["pff.h"])
    assert model is not None or ended is None
    if ended:
        assert compiler_says((bench.folder / "pff.h").read_text()) == ""
    ended = bench.run(
        "rig", "run", RUN, "--model", "model.h5", names=["model.h5"],
        accepted=lambda ended: "not armed, nothing was moved" in ended.err,
    )  # fmt: skip
    assert model is not None or ended is None
    if ended:
        settings = Settings().model_dump(mode="json")
        law = plan(RUN, settings, str(bench.folder / "model.h5")).law
        try:
            assert all(np.isfinite(law(k, NOW)).all() for k in range(20))
        except ControlError:  # P_ff is not finite: the run stops
            pass
