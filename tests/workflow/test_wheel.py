"""The wheel works alone, outside the checkout."""

import json
import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path
from sysconfig import get_path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.slow

#: What a user of the wheel does: the models, then the commands that are arguments.
LINES = """
import json, sys
import numpy as np
import fprc.models
from fprc.cli import main
from fprc.config import check

X = np.random.default_rng(0).standard_normal((300, 2)).cumsum(axis=0)
model = fprc.models.FPRC(n_c=2, random_state=0).fit(X, X @ [1.0, 2.0])
steps = [model.step(x) for x in X]
print(json.dumps({
    "codes": [main(command.split()) for command in sys.argv[1:]],
    "package": fprc.__file__,
    "apart": float(np.abs(model.predict(X) - steps).max()),
    "rig": check({}).fitted.name,
}))
"""
#: What each command leaves in the folder.
WRITTEN = {"import log.csv --map map.yaml --out sweep.h5": "sweep.h5", "rig run list": "."}
MAP = """
experiment: sweep
time: {column: t}
channels:
  theta_deg: {column: angle, unit: deg}
  p_exp_kpa: {column: force, unit: kPa}
"""


def build(kind, source, out):
    """Build ``sdist`` or ``wheel`` of a folder with its own backend; return the file."""
    code = f"from setuptools.build_meta import *; print(build_{kind}({str(out)!r}))"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=source, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return out / done.stdout.splitlines()[-1]


@pytest.fixture(scope="module")
def sdist(tmp_path_factory):
    """Build the archive of the sources and unpack it; return its folder."""
    folder = tmp_path_factory.mktemp("sdist")
    left_out = shutil.ignore_patterns(
        ".git", ".venv", "__pycache__", "*.egg-info", "*.h5", ".snakemake", "_build"
    )
    shutil.copytree(ROOT, folder / "copy", ignore=left_out, symlinks=True)
    archive = build("sdist", folder / "copy", folder)
    with tarfile.open(archive) as file:
        # Python 3.11.3 and before do not have the filter
        file.extractall(folder, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
    return folder / archive.name.removesuffix(".tar.gz")


@pytest.fixture(scope="module")
def wheel(sdist):
    """Build the wheel from the unpacked archive."""
    return build("wheel", sdist, sdist.parent)


@pytest.fixture(scope="module")
def run(wheel, tmp_path_factory):
    """Return what runs a Python with the wheel and the libraries of this one, in a folder.

    Its environment names neither the checkout nor a home.
    """
    venv = tmp_path_factory.mktemp("installed")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", venv], check=True)
    packages = Path(get_path("purelib", "venv", {"base": str(venv)}))
    with zipfile.ZipFile(wheel) as file:
        file.extractall(packages)
    (packages / "libraries.pth").write_text(get_path("purelib") + "\n", encoding="utf-8")

    def run(place, *arguments):
        environment = {"PATH": os.environ["PATH"], "HOME": str(place)}
        done = subprocess.run(
            [venv / "bin/python", *arguments], cwd=place, env=environment, capture_output=True,
            text=True,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return done

    return run


def test_commands_and_models_work_outside_the_checkout(run, tmp_path):
    time_s = np.arange(6000) / 200.0
    angle = 20.0 + 10.0 * np.sin(2.0 * time_s)
    table = np.column_stack([time_s, angle, 100.0 + 3.0 * angle])
    np.savetxt(tmp_path / "log.csv", table, delimiter=",", header="t,angle,force", comments="")
    (tmp_path / "map.yaml").write_text(MAP)
    done = run(tmp_path, "-c", LINES, *WRITTEN)
    found = json.loads(done.stdout.splitlines()[-1])
    assert not Path(found["package"]).is_relative_to(ROOT)
    assert found["apart"] < 1e-9
    assert found["rig"] == "paper"
    assert set(found["codes"]) == {0}, done.stderr
    assert [name for name in WRITTEN.values() if not (tmp_path / name).exists()] == []


def test_command_prints_a_file_of_the_package(run, tmp_path):
    """The file is that of the repository, so that no copy can differ."""
    printing = "from fprc.cli import main; main(['config', 'rig', 'viscous'])"
    text = (ROOT / "src/fprc/config/rigs/viscous.yaml").read_text(encoding="utf-8")
    assert run(tmp_path, "-c", printing).stdout == text


def test_archive_has_every_file_and_the_wheel_every_one_of_the_package(sdist, wheel):
    listed = subprocess.run(
        ["git", "-C", ROOT, "ls-files", "-z"], capture_output=True, text=True, check=False
    )
    if listed.returncode:
        pytest.skip("not a git checkout, so the list of files is unknown")
    tracked = {name for name in listed.stdout.split("\0") if name and (ROOT / name).exists()}
    assert {name for name in tracked if not (sdist / name).is_file()} == set()
    with zipfile.ZipFile(wheel) as file:
        packed = {f"src/{name}" for name in file.namelist()}
    assert {name for name in tracked if name.startswith("src/")} <= packed
