"""The plain code of the workflow benchmark gives the same results as ours."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

import fprc

PACKAGE = Path(fprc.__file__).parent

#: The rig under changing valves and pushes; the steps of each model; the states of the ESN.
SCRIPT = """
import json

import numpy as np

import fprc
from fprc.config import Settings
from fprc.devices.sim import SimulatedRig
from fprc.models import FPRC, EchoStates, FuzzyLinear, TapFeatures
from fprc.models.kernels import alternate

rig = SimulatedRig(
    Settings().model_dump()["rig"], seed=1, run=2, sample_rate_hz=200.0, push_kpa=lambda k: 0.1 * k
)
readings = []
for k in range(100):
    rig.wait_for(k)
    readings.append(rig.read())
    rig.write(6.0 - k / 50, 5.0 + k / 100)

k = np.arange(60.0)
X = np.column_stack([30.0 + k, 150.0 + 9.0 * np.sin(k), 140.0 + 9.0 * np.cos(k)])
found = {"rig": readings}
network = EchoStates(r=20, random_state=1).fit(X[:, :1])
found["states"] = network.transform(X[:, :1]).tolist()
for name, features, columns in (
    ("esn", network, 1),
    ("one readout", TapFeatures(epsilon=0.1), 2),
    ("two readouts", TapFeatures(n_y=1, n_u=2, epsilon=0.1), 3),
    ("references", TapFeatures(n_y=2, n_references=None), 3),
):
    features.fit(X[:, :columns])
    found[name] = [features.step(x).tolist() for x in X[:, :columns]]
for model, columns in ((FPRC(n_c=2, random_state=1), 2), (FuzzyLinear(n_c=2, random_state=1), 1)):
    model = model.assembled(model.make_features().fit(X[:, :columns]), model.make_readout())
    rows = model.features_.transform(X[:, :columns])
    model.readout_.centers_ = rows[[0, 30]]
    model.readout_.W_out_ = np.outer([1.0, -1.0], np.arange(1.0 + rows.shape[1]))
    found[type(model).__name__] = [model.step(x) for x in X[:, :columns]]
print(json.dumps({"where": fprc.__file__, "compiled": hasattr(alternate, "py_func"), **found}))
"""


@pytest.fixture
def whole(tool):
    return tool("benchmark.whole")


@pytest.mark.slow
def test_plain_implementations_are_used_and_give_the_same(whole, tmp_path):
    shutil.copytree(PACKAGE, tmp_path / "fprc", ignore=shutil.ignore_patterns("__pycache__"))
    whole.make_plain(tmp_path / "fprc")
    ours, theirs = (
        json.loads(
            subprocess.run(
                [sys.executable, "-c", SCRIPT],
                env=os.environ | {"PYTHONPATH": str(folder)},
                capture_output=True,
                text=True,
                check=True,
            ).stdout
        )
        for folder in (PACKAGE.parent, tmp_path)
    )
    assert Path(theirs.pop("where")).is_relative_to(tmp_path)
    assert Path(ours.pop("where")).is_relative_to(PACKAGE)
    assert (ours.pop("compiled"), theirs.pop("compiled")) == (True, False)
    assert ours.keys() == theirs.keys()
    for name, values in ours.items():
        assert_allclose(theirs[name], values, rtol=1e-11, err_msg=name)
