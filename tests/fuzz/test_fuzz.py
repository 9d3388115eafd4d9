"""Models that were changed at random behind a renewed checksum: refused, or they give numbers.

`.ci/weekly` tries more of them.
"""

import json
import os
from random import Random

import h5py
import numpy as np
import pytest

from fprc.apparatus.command import plan
from fprc.channels import Readings
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

WAVE = 30.0 - 25.0 * np.cos(np.arange(300) / 40.0)
X, Y = np.column_stack([WAVE, 100.0 + 0.2 * np.roll(WAVE, 20)]), 7.0 * WAVE
MAPS = [(PlayOperators(n_plays=3), [0]), (NVAR(n_taps=2, spacing=3), [0, 1]),
        (LowpassBank((1.0, 0.1)), [1, 0])]  # fmt: skip
MODELS = [(FPRC(n_c=3, random_state=1), 2), (ESN(r=9, washout=5, random_state=1), 1),
          (FeatureModel(SideBySide(MAPS), RidgeReadout()), 2)]  # fmt: skip
#: What replaces a value of a model's description.
ODD = (
    None, True, 0, -1, 2, 50, 10**5, 10**30, -0.0, 0.5, 1e-300, 1e308, "", "x", "FPRC",
    "SequenceModel", "RidgeReadout", [], {}, [1], [[0.5]], ["a"], [["a", 3, None]], {"array": "x"},
    float("nan"), float("inf"), "__class__", {"class": "FPRC", "parameters": {}, "learned": {}},
    {"class": "TapFeatures", "parameters": {"n_y": 10**9}, "learned": {}},
)  # fmt: skip


def nodes(value):
    """Return every container and key in a description."""
    if not isinstance(value, dict | list):
        return []
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    return [pair for key, child in inner for pair in [(value, key), *nodes(child)]]


def change_description(file, draw):
    """Change or remove a value of the description, or add one."""
    described = json.loads(file["model"][()])
    inner, key = draw.choice(nodes(described))
    if isinstance(inner, dict):
        key = draw.choice([key, key, "more_", "__init__"])
    if draw.random() < 0.8 or isinstance(inner, list) or key not in inner:
        inner[key] = draw.choice(ODD)
    else:
        del inner[key]
    del file["model"]
    file["model"] = np.bytes_(json.dumps(described).encode())


def change_array(file, draw):
    """Replace an array by one of other values or shape."""
    name = draw.choice([name for name in file if name != "model"])
    values = np.atleast_1d(file[name][()])
    odd = values.astype(float)
    odd.reshape(-1)[draw.randrange(odd.size)] = draw.choice(
        [np.nan, np.inf, 0.0, 7.0, -1e30, 1e300, 5e-324]
    )
    ways = [odd, odd, values[:-1], values[:0], values.T, values[None], values * 1e20, -values,
            np.repeat(values, 2, axis=0)]  # fmt: skip
    del file[name]
    file[name] = draw.choice(ways)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(int(os.environ.get("FPRC_EXAMPLES", "20"))))
def test_model_with_a_renewed_checksum_is_refused_or_gives_numbers(seed, tmp_path):
    draw, path = Random(seed), tmp_path / "model.h5"
    model, columns = draw.choice(MODELS)
    save_model(model.fit(X[:, :columns], Y), path)
    if change := draw.choice([None, change_array, change_description]):
        with h5py.File(path, "a") as file:
            change(file, draw)
    image = bytearray(path.read_bytes()[512:])
    if not change:
        image[draw.randrange(len(image))] ^= draw.randrange(1, 256)
    path.write_bytes(sealed(bytes(image)))
    run, settings = "track_sine_0p2_fprc", Settings().model_dump(mode="json")
    try:
        loaded = load_model(path)
    except FprcError:
        with pytest.raises(FprcError, match=path.name):
            plan(run, settings, str(path))
        return
    rows = np.random.default_rng(1).uniform(0.0, 100.0, (60, loaded.n_features_in_))
    output, steps = loaded.predict(rows), np.array([loaded.step(x) for x in rows])
    assert np.isfinite(output).all()
    assert np.abs(steps - output).max() <= 1e-6 * np.abs(output).max() + 1e-6
    try:
        law = plan(run, settings, str(path)).law
        rows = [law(k, Readings(0.0, 1.0, 20.0, 2.0, 100.0, 0.0)) for k in range(20)]
    except FprcError:  # another model than that of the run, or P_ff is not finite
        return
    assert np.isfinite(rows).all()
