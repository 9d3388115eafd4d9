"""Which edits change the fingerprint of a rule, and which do not."""

import importlib
import re
import sys
from pathlib import Path

import pytest

import fprc
from fprc import fingerprint as module
from fprc.fingerprint import fingerprint

REAL = Path(fprc.__path__[0])

#: A stage, and what it imports directly, through a package, lazily, and for its types alone.
FAKE = {
    "__init__.py": "VERSION = 1\n",
    "stages/__init__.py": "HEAD = 1\n",
    "stages/judge.py": """
from typing import TYPE_CHECKING

import numpy as np

from fprc.data import read
from fprc.models import FPRC

if TYPE_CHECKING:
    from fprc.typed import Named


def judge(path: str) -> "Named":
    from fprc.lazy import late

    return late(FPRC().fit(read(path)))
""",
    "data.py": "import fprc.files\n\n\ndef read(path):\n    return fprc.files.load(path)\n",
    "files.py": "def load(path):\n    return path\n",
    "models/__init__.py": "from fprc.models.esn import ESN\nfrom fprc.models.own import FPRC\n",
    "models/esn.py": "class ESN:\n    pass\n",
    "models/own.py": "from fprc import shared\n\n\nclass FPRC:\n    fit = shared.solve\n",
    "shared.py": "def solve(x):\n    return x\n",
    "lazy.py": "def late(x):\n    return x\n",
    "typed.py": "class Named:\n    pass\n",
    "other.py": "def unused():\n    return 1\n",
}


def forget():
    """Begin as a new process would."""
    for cached in (module._path, module._source):
        cached.cache_clear()


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Take a fake package for ours; gives its folder."""
    monkeypatch.setattr(fprc, "__path__", [str(tmp_path / "fprc")])
    for name, text in FAKE.items():
        path = tmp_path / "fprc" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    forget()
    yield tmp_path / "fprc"
    forget()


def code(*names):
    forget()
    return fingerprint(*(names or ("fprc.stages.judge",)))


def edit(path, old, new):
    text = path.read_text(encoding="utf-8")
    assert text.count(old) == 1
    path.write_text(text.replace(old, new), encoding="utf-8")


IMPORTED = ["stages/judge", "data", "files", "models/own", "shared", "lazy"]
OTHERS = ["other", "typed", "models/esn", "models/__init__", "stages/__init__", "__init__"]


@pytest.mark.parametrize("name", IMPORTED + OTHERS)
def test_edit_of_what_is_imported_changes_it_and_no_other_edit(package, name):
    before = code()
    path = package / f"{name}.py"
    path.write_text(path.read_text(encoding="utf-8") + "\n\nLIMIT = 2\n", encoding="utf-8")
    assert (code() != before) is (name in IMPORTED)


def test_comment_docstring_and_layout_do_not(package):
    before = code()
    path = package / "files.py"
    path.write_text(
        '"""Files."""\n\n\ndef load(\n    path,\n):\n    """Load."""\n    # quickly\n'
        "    return (path)\n",
        encoding="utf-8",
    )
    assert code() == before


def test_text_that_is_no_docstring_counts(package):
    edit(package / "files.py", "return path", 'return path + "a"')
    before = code()
    edit(package / "files.py", '"a"', '"b"')
    assert code() != before


def test_name_that_a_package_defines_itself_counts_the_package(package):
    edit(package / "stages/judge.py", "import FPRC", "import FPRC, LIMIT")
    edit(package / "models/__init__.py", "import ESN\n", "import ESN\nLIMIT = 2\n")
    before = code()
    edit(package / "models/__init__.py", "LIMIT = 2", "LIMIT = 3")
    assert code() != before


def test_modules_are_counted_in_any_order_and_once(package):
    both = code("fprc.data", "fprc.lazy")
    assert both == code("fprc.lazy", "fprc.data", "fprc.files", "fprc.lazy")
    assert both not in (code("fprc.data"), code("fprc.lazy"))


def test_circle_of_imports_is_no_obstacle(package):
    path = package / "files.py"
    path.write_text("import fprc.data\n\n" + path.read_text(encoding="utf-8"), encoding="utf-8")
    assert code("fprc.data") == code("fprc.files")


@pytest.fixture
def mine(package, tmp_path, monkeypatch):
    """Modules of a user: a model, what it imports, and what only its neighbour imports."""
    folder = tmp_path / "project"
    (folder / "mine").mkdir(parents=True)
    for name, text in {
        "model.py": "import fprc.data\nimport helper\nfrom mine import Taps\n\nORDER = 1\n",
        "helper.py": "import json\n\nWIDTH = 1\n",
        "mine/__init__.py": "from .taps import Taps\n",
        "mine/taps.py": "from . import lags\n\n\nclass Taps:\n    LAGS = lags.LAGS\n",
        "mine/lags.py": "LAGS = 1\n",
        "other.py": "OTHER = 1\n",
    }.items():
        (folder / name).write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(str(folder))
    for name in ("model", "other"):
        importlib.import_module(name)
    yield folder
    for name in ("model", "helper", "other", "mine", "mine.taps", "mine.lags"):
        sys.modules.pop(name, None)
    for name in ("data", "files"):
        sys.modules.pop(f"fprc.{name}", None)
        delattr(fprc, name)


@pytest.mark.parametrize(
    ("edited", "counts"),
    [("model", True), ("helper", True), ("mine/taps", True), ("mine/lags", True),
     ("mine/__init__", False), ("other", False)],
)  # fmt: skip
def test_model_of_a_user_counts_with_what_it_imports(mine, edited, counts):
    before = code("fprc.lazy", "model")
    assert before != code("fprc.lazy")
    path = mine / f"{edited}.py"
    path.write_text(path.read_text(encoding="utf-8") + "\n# a comment\n", encoding="utf-8")
    assert code("fprc.lazy", "model") == before
    path.write_text(path.read_text(encoding="utf-8") + "\nLIMIT = 2\n", encoding="utf-8")
    assert (code("fprc.lazy", "model") != before) is counts


def test_module_of_the_package_that_a_users_model_imports_counts(mine, package):
    before = code("model")
    edit(package / "files.py", "return path", "return path.strip()")
    assert code("model") != before


def test_library_counts_only_if_it_is_named():
    assert module._path("json") is None
    assert module._closure(("fprc.errors", "json")) == {"fprc.errors", "json"} | module._closure(
        ("fprc.errors",)
    )


@pytest.mark.parametrize("folder", ["site-packages", "dist-packages"])
def test_library_of_another_environment_does_not_count(mine, tmp_path, monkeypatch, folder):
    """As with `pip install --user`, or libraries of the system."""
    (tmp_path / folder).mkdir()
    library = tmp_path / folder / "elsewhere.py"
    library.write_text("LIMIT = 1\n", encoding="utf-8")
    monkeypatch.syspath_prepend(str(library.parent))
    importlib.import_module("elsewhere")
    assert module._path("elsewhere") is None
    assert module._path("helper") == mine / "helper.py"


def test_name_that_a_package_imports_from_itself_is_no_obstacle(mine):
    (mine / "mine/__init__.py").write_text("from . import compiled\n", encoding="utf-8")
    (mine / "model.py").write_text("from mine import compiled\n", encoding="utf-8")
    before = code("model")
    edit(mine / "mine/__init__.py", "compiled", "compiled as compiled")
    assert code("model") != before


def test_training_runs_neither_another_model_nor_the_rig_nor_figures():
    found = module._closure(("fprc.stages.judge", "fprc.models.fprc"))
    assert not found & {"fprc.models.esn", "fprc.rig.valve", "fprc.figures.style"}


def test_our_own_code_has_no_import_that_would_not_be_followed():
    for path in REAL.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"^ *from (\.|fprc\S* import \*)", text, re.MULTILINE), path
