"""The wheel works alone, outside the checkout."""

import json
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from pathlib import Path
from sysconfig import get_path

import numpy as np
import pytest
import yaml

ROOT = Path(__file__).parents[2]
PACKAGED = ROOT / "src/fprc/config"
pytestmark = pytest.mark.slow

#: What a user of the wheel does: the models, then the commands that are arguments.
LINES = """
import json, sys
import numpy as np
import fprc.models
from fprc.cli import main
from fprc.config import check

rng = np.random.default_rng(0)
X = rng.standard_normal((300, 2)).cumsum(axis=0)
model = fprc.models.FPRC(n_c=2, random_state=0).fit(X, X @ [1.0, 2.0])
steps = [model.step(x) for x in X]
print(json.dumps({
    "codes": [main(command.split()) for command in sys.argv[1:]],
    "package": fprc.__file__,
    "apart": float(np.abs(model.predict(X) - steps).max()),
    "rig": check({}).fitted.name,
}))
"""
IMPORT = "import log.csv --map one.yaml --out sweep.h5"
READOUT = "readout log.csv --map two.yaml --config few.yaml"
LIST = "rig run list"
#: What each command leaves in the folder.
WRITTEN = {IMPORT: "sweep.h5", READOUT: "results/log/report.md", LIST: None}

#: Small models.
FEW = """
experiments: {sweep: {duration_s: 20}, complex: {duration_s: 20}}
models: {fprc: {n_c: 2}, n_y: 2, esn: {r: 5}}
grids: {epsilon: [1, 0.1, 0.01], n_c: [1, 2, 4]}
evaluation: {folds: 2, purge_s: 0.2}
"""
COLUMNS = {
    "theta_deg": {"column": "angle", "unit": "deg"},
    "p_exp_kpa": {"column": "force", "unit": "kPa"},
    "p_o_kpa": {"column": "memory", "unit": "kPa"},
}


@pytest.fixture(scope="module")
def folder():
    """Return a folder that every user can enter."""
    with tempfile.TemporaryDirectory() as name:
        Path(name).chmod(0o755)
        yield Path(name)


def build(kind, source, out):
    """Build ``sdist`` or ``wheel`` of a folder with its own backend; return the file."""
    code = f"from setuptools.build_meta import *; print(build_{kind}({str(out)!r}))"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=source, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return out / done.stdout.splitlines()[-1]


@pytest.fixture(scope="module")
def sdist(folder):
    """Build the archive of the sources and unpack it; return its folder."""
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
def wheel(sdist, folder):
    """Build the wheel from the unpacked archive."""
    return build("wheel", sdist, folder)


def install(wheel, venv, python=sys.executable):
    """Install a wheel in an environment that also finds the libraries of this one.

    It does not find an editable installation of this project. Returns its Python.
    """
    subprocess.run([python, "-m", "venv", "--without-pip", venv], check=True)
    packages = Path(get_path("purelib", "venv", {"base": str(venv)}))
    with zipfile.ZipFile(wheel) as file:
        file.extractall(packages)
    (packages / "libraries.pth").write_text(get_path("purelib") + "\n", encoding="utf-8")
    return venv / "bin/python"


@pytest.fixture(scope="module")
def python(wheel, folder):
    return install(wheel, folder / "installed")


@pytest.fixture
def place(folder):
    """Make a folder with a recording and its maps, outside the checkout."""
    place = Path(tempfile.mkdtemp(dir=folder))
    time_s = np.arange(6000) / 200.0
    angle = 20.0 + 10.0 * np.sin(2.0 * time_s) + 8.0 * np.sin(3.3 * time_s)
    past = 0.2 * np.cumsum(np.random.default_rng(5).standard_normal(len(time_s)))
    table = np.column_stack([time_s, angle, past, 100.0 + 3.0 * angle + past])
    np.savetxt(place / "log.csv", table, delimiter=",", header="t,angle,memory,force", comments="")
    given = {"time": {"column": "t"}, "channels": COLUMNS}
    (place / "one.yaml").write_text(yaml.safe_dump({"experiment": "sweep"} | given))
    (place / "two.yaml").write_text(yaml.safe_dump({"test_from_s": 20} | given))
    (place / "few.yaml").write_text(FEW)
    return place


def run(python, place, *arguments, home="/dev/null", **options):
    """Run Python in a folder; its environment names neither the checkout nor a home."""
    environment = {"PATH": os.environ["PATH"], "HOME": home}
    return subprocess.run(
        [python, *arguments], cwd=place, env=environment, capture_output=True, text=True, **options
    )


def test_commands_and_models_work_outside_the_checkout(python, place):
    done = run(python, place, "-c", LINES, *WRITTEN, home=str(place))
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    assert Path(found["package"]).is_relative_to(python.parents[1])
    assert found["apart"] < 1e-9
    assert found["rig"] == "paper"
    assert set(found["codes"]) == {0}, done.stderr
    assert {"sweep", "complex"} <= set(done.stdout.split())
    for name in filter(None, WRITTEN.values()):
        assert (place / name).exists()


def test_command_prints_the_files_of_the_package(python, place):
    """The files are those of the repository, so that no copy can differ."""
    printing = (
        "import sys; from fprc.cli import main; [main(command.split()) for command in sys.argv[1:]]"
    )
    commands = ("config rig", "config rig viscous", "config published")
    done = run(python, place, "-c", printing, *commands)
    files = ("rigs/paper.yaml", "rigs/viscous.yaml", "published.yaml")
    assert done.stdout == "".join((PACKAGED / file).read_text(encoding="utf-8") for file in files)


@pytest.fixture(scope="module")
def tracked():
    """Return the files that git tracks."""
    listed = subprocess.run(
        ["git", "-C", ROOT, "ls-files", "-z"], capture_output=True, text=True, check=False
    )
    if listed.returncode:
        pytest.skip("not a git checkout, so the list of files is unknown")
    return {name for name in listed.stdout.split("\0") if name and (ROOT / name).exists()}


def test_archive_of_the_sources_has_tests_settings_tools_and_workflow(sdist, tracked):
    assert {name for name in tracked if not (sdist / name).is_file()} == set()


def test_wheel_has_every_file_of_the_package(wheel, tracked):
    with zipfile.ZipFile(wheel) as file:
        packed = {f"src/{name}" for name in file.namelist()}
    assert {name for name in tracked if name.startswith("src/")} <= packed
