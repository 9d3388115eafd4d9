"""Recordings and models that were damaged at random: refused with a message, or read as they are.

Tables of damage are with the tests of logs, journals and models. `.ci/weekly` draws more of it, and
other damage in each run.
"""

import json
import os
import random
from contextlib import chdir
from copy import deepcopy

import h5py
import numpy as np
import pandas as pd
import pytest
import scipy.io
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fprc.apparatus.programme import plan
from fprc.channels import Readings
from fprc.cli import main
from fprc.config import Settings
from fprc.errors import FprcError
from fprc.models import (
    ESN,
    FPRC,
    NVAR,
    FeatureModel,
    LowpassBank,
    PlayOperators,
    RidgeReadout,
    SideBySide,
    load_model,
    save_model,
)
from fprc.models.storage import sealed

pytestmark = pytest.mark.slow

_ASKED = os.environ.get("FPRC_EXAMPLES")
FUZZ = settings(
    max_examples=int(_ASKED or "6"), deadline=None, derandomize=not _ASKED,
    suppress_health_check=list(HealthCheck),
)  # fmt: skip


@st.composite
def damaged(draw, data):
    """Draw damage to some bytes: bit errors, special text, and stretches, as disks leave them."""
    noise = random.Random(draw(st.integers(0, 2**32)))
    size = min(1 << draw(st.integers(0, 12)), max(len(data) // 2, 1))
    at = draw(st.integers(0, max(len(data) - size, 0)))
    end, flipped = at + size, bytearray(data)
    flipped[at] ^= 1 << noise.randrange(8)
    special = noise.choice(b'"|,|;|\n|\r|\0|\xff|\xef\xbb\xbf|\x1b[2J|#|\t|e|-|.|*|&|{'.split(b"|"))
    ways = [
        bytes(flipped),
        data[:at] + special + data[at:],
        data[:at],
        data[:at] + bytes(size) + data[end:],
        data[:at] + noise.randbytes(size) + data[end:],
        data[:at] + data[end:],
        data[:end] + data[at:],
    ]
    return draw(st.sampled_from(ways))


TIME_S = np.arange(300) / 200.0
WAVE = 30.0 - 25.0 * np.cos(5.0 * TIME_S)
X, Y = np.column_stack([WAVE, 100.0 + 0.2 * np.roll(WAVE, 20)]), 7.0 * WAVE

MAP = {
    "experiment": "sweep",
    "time": {"column": "t"},
    "channels": {
        "theta_deg": {"column": "angle", "unit": "deg"},
        "p_exp_kpa": {"column": "p", "unit": "kPa"},
    },
}


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    """Bytes of a recording by the ending of its file."""
    folder = tmp_path_factory.mktemp("recordings")
    table = pd.DataFrame({"t": TIME_S, "angle": X[:, 0], "p": Y})
    table.to_csv(folder / "arm.csv", index=False)
    scipy.io.savemat(folder / "arm.mat", dict(table.items()), do_compression=True)
    np.savez_compressed(folder / "arm.npz", **dict(table.items()))
    table.to_excel(folder / "arm.xlsx", index=False)
    return {path.suffix: path.read_bytes() for path in sorted(folder.iterdir())}


@FUZZ
@given(st.data())
def test_recording_is_refused_or_imported_in_numbers(recordings, tmp_path_factory, capsys, draw):
    ending = draw.draw(st.sampled_from(list(recordings)))
    folder, name = tmp_path_factory.mktemp("import"), f"arm{ending}"
    (folder / name).write_bytes(draw.draw(damaged(recordings[ending])))
    (folder / "map.yaml").write_text(yaml.safe_dump(MAP))
    with chdir(folder):  # a traceback or a warning ends the test
        codes = [
            main(["import", name, *more])
            for more in (["--draft"], ["--map", "map.yaml", "--out", "out.h5"])
        ]
    said = capsys.readouterr().err
    assert set(codes) <= {0, 1}
    assert (1 in codes) is ("error: " in said)
    assert 1 not in codes or name in said
    assert (folder / "out.h5").exists() is (codes[1] == 0)
    if codes[1] == 0:
        with h5py.File(folder / "out.h5") as file:
            assert all(np.isfinite(file[channel][()]).all() for channel in file)


#: What replaces a value of a model's description.
ODD_VALUES = (
    None, True, 0, -1, 2, 50, 10**5, 10**30, -0.0, 0.5, 1e-300, 1e308, "", "x", "FPRC",
    "SequenceModel", "RidgeReadout", [], {}, [1], [[0.5]], ["a"], [["a", 3, None]], {"array": "x"},
    float("nan"), float("inf"), "__class__", {"class": "FPRC", "parameters": {}},
    {"class": "TapFeatures", "parameters": {"n_y": 10**9}},
)  # fmt: skip
MAPS = [(PlayOperators(n_plays=3), [0]), (NVAR(n_taps=2, spacing=3), [0, 1]),
        (LowpassBank((1.0, 0.1)), [1, 0])]  # fmt: skip


@pytest.fixture(scope="module")
def models(tmp_path_factory):
    """Bytes of the files of fitted models."""
    path, files = tmp_path_factory.mktemp("models") / "model.h5", []
    made = FPRC(n_c=3, random_state=1), FeatureModel(SideBySide(MAPS), RidgeReadout())
    for model, columns in zip((*made, ESN(r=9, washout=5, random_state=1)), (2, 2, 1), strict=True):
        save_model(model.fit(X[:, :columns], Y), path)
        files.append(path.read_bytes())
    return files


def nodes(value):
    """Return every container and key in a description."""
    if not isinstance(value, dict | list):
        return []
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    return [pair for key, child in inner for pair in [(value, key), *nodes(child)]]


def change_description(file, draw):
    """Change or remove a value of the description, or add one."""
    described = json.loads(file["model"][()])
    inner, key = draw(st.sampled_from(nodes(described)))
    odd = deepcopy(draw(st.sampled_from(ODD_VALUES)))
    if isinstance(inner, dict):
        key = draw(st.sampled_from([key, key, "more_", "__init__"]))
    if draw(st.integers(0, 4)) or key not in inner:
        inner[key] = odd
    else:
        inner.pop(key)
    del file["model"]
    file["model"] = np.bytes_(json.dumps(described).encode())


def change_array(file, draw):
    """Replace an array by one of other values or shape."""
    name = draw(st.sampled_from([name for name in file if name != "model"]))
    values = np.atleast_1d(file[name][()])
    flat = values.astype(float).reshape(-1)
    odd = st.sampled_from([np.nan, np.inf, 0.0, 7.0, -1e30, 1e300, 5e-324])
    flat[draw(st.integers(0, flat.size - 1))] = draw(odd)
    ways = [flat.reshape(values.shape), values[:-1], values[:0], values.T, values[None],
            np.repeat(values, 2, axis=0), values * 1e20, -values]  # fmt: skip
    del file[name]
    file[name] = draw(st.sampled_from(ways))


@FUZZ
@given(st.data())
def test_model_with_a_renewed_checksum_is_refused_or_gives_numbers(models, tmp_path_factory, draw):
    path = tmp_path_factory.mktemp("model") / "model.h5"
    path.write_bytes(draw.draw(st.sampled_from(models)))
    if change := draw.draw(st.sampled_from([None, change_array, change_description])):
        with h5py.File(path, "a") as file:
            change(file, draw.draw)
        inner = path.read_bytes()[512:]
    else:
        inner = draw.draw(damaged(path.read_bytes()[512:]))
    path.write_bytes(sealed(inner))
    run, settings_ = "track_sine_0p2_fprc", Settings().model_dump(mode="json")
    try:
        loaded = load_model(path)
    except FprcError:
        with pytest.raises(FprcError, match=path.name):
            plan(run, settings_, str(path))
        return
    rows = np.random.default_rng(1).uniform(0.0, 100.0, (60, loaded.n_features_in_))
    output, steps = loaded.predict(rows), np.array([loaded.step(x) for x in rows])
    assert np.isfinite(output).all()
    assert np.abs(steps - output).max() <= 1e-6 * np.abs(output).max() + 1e-6
    now = Readings(0.0, 1.0, 20.0, 2.0, 100.0, 0.0)
    try:
        law = plan(run, settings_, str(path)).law
        assert all(np.isfinite(law(k, now)).all() for k in range(20))
    except FprcError:  # another model than that of the run, or P_ff is not finite
        pass
