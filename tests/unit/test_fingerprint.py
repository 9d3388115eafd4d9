import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import fprc
from fprc.fingerprint import fingerprint

#: A package with the real fingerprint module and little else.
SOURCES = {
    "__init__.py": '"""A package."""\n',
    "stages/__init__.py": '"""Stages."""\n',
    "stages/judge.py": "from fprc.models.linear import fit\n\n\ndef judge():\n    return fit(1)\n",
    "stages/draw.py": "from fprc import figures\n\n\ndef draw():\n    return figures.WIDTH\n",
    "models/__init__.py": '"""Models."""\n',
    "models/linear.py": '''"""Linear model."""

from fprc import solver


def fit(alpha):
    """Fit."""
    # comment
    if alpha < 0:
        raise ValueError("use a larger alpha")
    return solver.solve(alpha)


class Model:
    """A model."""
''',
    "solver.py": "def solve(alpha):\n    return alpha + 1\n",
    "figures.py": "WIDTH = 3.5\n",
    "signals.py": "RATE = 200\n",
}

SCRIPT = """
import sys
import fprc
from fprc.fingerprint import fingerprint
print(fprc.__file__)
for module in sys.argv[1:]:
    print(fingerprint(module))
"""


class Package:
    """A package that a test may edit."""

    def __init__(self, folder):
        self.folder = folder / "fprc"

    def fingerprints(self, *modules):
        """Return those of the modules, from a new process."""
        environment = os.environ | {"PYTHONPATH": str(self.folder.parent)}
        command = [sys.executable, "-W", "error", "-c", SCRIPT, *modules]
        run = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)
        assert run.returncode == 0, run.stderr
        origin, *found = run.stdout.split()
        assert Path(origin) == self.folder / "__init__.py"
        return found

    def both(self):
        return self.fingerprints("fprc.stages.judge", "fprc.stages.draw")

    def edit(self, module, old, new):
        path = self.folder / module
        text = path.read_text(encoding="utf-8")
        assert text.count(old) == 1
        path.write_text(text.replace(old, new), encoding="utf-8")


def small(folder):
    package = Package(folder)
    for name, text in SOURCES.items():
        path = package.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    shutil.copy(Path(fprc.__file__).parent / "fingerprint.py", package.folder)
    return package


@pytest.fixture
def package(tmp_path):
    return small(tmp_path)


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    return small(tmp_path_factory.mktemp("original")).both()


def test_fingerprints_of_two_stages_differ(original):
    judge, draw = original
    assert judge != draw
    assert len(judge) == len(draw) == 16


def test_fingerprint_of_the_same_code_elsewhere_is_the_same(package, original):
    assert package.both() == original


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("# comment", "# another comment"),
        ('"""Linear model."""', '"""Another sentence."""'),
        ('"""Fit."""', '"""Fit it.\n\n    In two lines.\n    """'),
        ('    """Fit."""\n', ""),
        ('"""A model."""', '"""Another model."""'),
        ("solver.solve(alpha)", "solver.solve(\n        alpha\n    )"),
    ],
    ids=["comment", "module", "function", "none", "class", "layout"],
)
def test_comments_docstrings_and_layout_do_not_count(package, original, old, new):
    package.edit("models/linear.py", old, new)
    assert package.both() == original


@pytest.mark.parametrize(
    ("module", "old", "new"),
    [
        ("stages/judge.py", "fit(1)", "fit(2)"),
        ("models/linear.py", "alpha < 0", "alpha <= 0"),
        ("models/linear.py", "use a larger alpha", "take a larger alpha"),
        ("solver.py", "alpha + 1", "alpha - 1"),
    ],
    ids=["itself", "imported", "text that is no docstring", "imported by what it imports"],
)
def test_code_counts_for_the_stage_that_imports_it_alone(package, original, module, old, new):
    package.edit(module, old, new)
    judge, draw = package.both()
    assert judge != original[0]
    assert draw == original[1]


def test_code_that_no_stage_imports_does_not_count(package, original):
    package.edit("signals.py", "200", "100")
    assert package.both() == original


def test_module_counts_once_it_is_imported_even_inside_a_function(package, original):
    package.edit("stages/draw.py", "    return", "    from fprc import signals\n    return")
    _, before = package.both()
    package.edit("signals.py", "200", "100")
    judge, after = package.both()
    assert judge == original[0]
    assert original[1] != before != after


def test_real_ridge_counts_for_judging_and_not_for_the_readme(tmp_path):
    package = Package(tmp_path)
    skipped = shutil.ignore_patterns("__pycache__")
    shutil.copytree(Path(fprc.__file__).parent, package.folder, ignore=skipped)
    stages = "fprc.stages.judge", "fprc.stages.readme"
    judge, readme = (fingerprint(stage) for stage in stages)
    package.edit("models/ridge.py", "+ alpha * np", "+ 2.0 * alpha * np")
    changed, unchanged = package.fingerprints(*stages)
    assert changed != judge
    assert unchanged == readme
