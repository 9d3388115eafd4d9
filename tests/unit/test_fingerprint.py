"""Which edits change the digests of the code, and so which rules run again."""

import shutil
import sys
from pathlib import Path

import pytest

import fprc
from fprc.fingerprint import ELSEWHERE, SHOWS, code_that_computes, code_that_shows
from fprc.registry import MODELS

PACKAGE = Path(fprc.__path__[0])


@pytest.fixture
def changed(tmp_path, monkeypatch):
    """Return what edits a copy of the package, and names the digests that the edit changes."""
    shutil.copytree(PACKAGE, tmp_path / "fprc", ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(fprc, "__path__", [str(tmp_path / "fprc")])

    def digests():
        return {
            "shows": code_that_shows(),
            "studies": code_that_computes(also=("studies",)),
            "shared": code_that_computes(),
            **{name: code_that_computes(name) for name in MODELS},
        }

    def edit(name):
        before = digests()
        path = tmp_path / "fprc" / name
        path.write_bytes(path.read_bytes() + b"\nEDITED = 1\n")
        return {name for name, digest in digests().items() if digest != before[name]}

    return edit


COMPUTING = {"shared", "studies", *MODELS}


@pytest.mark.parametrize(
    ("name", "expected"),
    [("models/esn.py", {"esn"}), ("models/fprc.py", {"fprc", "fuzzy_linear"}),
     ("models/competitors.py", set()), ("models/features.py", COMPUTING),
     ("rig/mechanics.py", COMPUTING), ("signals.py", COMPUTING), ("stages/models.py", COMPUTING),
     ("stages/draw.py", {"shows"}), ("figures/style.py", {"shows"}),
     ("studies/family.py", {"studies"}),
     ("studies/beyond.py", {"shows"}), ("commands/files.py", set())],
)  # fmt: skip
def test_edit_of_a_module_changes_what_runs_it(changed, name, expected):
    assert changed(name) == expected


def test_model_from_outside_counts_by_the_file_of_its_class(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    path = tmp_path / "outside_of_this.py"
    text = "from fprc.models.esn import ESN\n\n\nclass Mine(ESN):\n    GAIN = 1\n"
    path.write_text(text, encoding="utf-8")
    other = {"estimator": "outside_of_this.Mine", "inputs": ["theta_deg"], "settings": {}}
    settings = {"others": {"mine": other}}
    before = code_that_computes("mine", settings=settings)
    path.write_text(text.replace("1", "2"), encoding="utf-8")
    assert code_that_computes("mine", settings=settings) != before
    del sys.modules["outside_of_this"]


def test_what_does_not_compute_is_there():
    assert [name for name in (*SHOWS, *ELSEWHERE) if not [*PACKAGE.glob(name)]] == []
