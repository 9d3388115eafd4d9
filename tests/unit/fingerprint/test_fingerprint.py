import shutil
from pathlib import Path

import pytest

import fprc
from fprc.fingerprint import closure, fingerprint, imports_of, known, reached, source

REAL = Path(fprc.__file__).parent
JUDGE, DRAW = "fprc.experiments.comparison.judge", "fprc.stages.draw.draw"

#: A small package.
SOURCES = {
    "__init__.py": '"""A package."""\n',
    "stages/__init__.py": '"""Stages."""\n',
    "stages/judge.py": """from fprc.models import Model, fit


def judge():
    return fit(1), Model()


def unused():
    return 7
""",
    "stages/draw.py": """from fprc import figures


def draw():
    return figures.WIDTH
""",
    "models/__init__.py": '''"""Models."""

from fprc.models.linear import Model, fit
from fprc.models.other import Other

__all__ = ["Model", "Other", "fit"]
''',
    "models/linear.py": '''"""Linear model."""

from math import sin as wave

from fprc import solver
from fprc.kinds import KINDS, Base, default, marked

LIMIT = 0


def fit(alpha, start=default(1)):
    """Fit."""
    # comment
    if alpha < LIMIT:
        raise ValueError("use a larger alpha")
    return solver.solve(alpha), KINDS["a"], wave(alpha)


class Model(Base):
    """A model."""

    size = 3

    @marked
    def step(self):
        """Step."""
        return self.size
''',
    "models/other.py": "class Other:\n    size = 5\n",
    "kinds.py": """def default(value):
    return value + 11


def marked(function):
    return function


def first():
    return 12


def second():
    return 13


KINDS = {"a": first, "b": second}


class Base:
    def reset(self):
        return 14


def alone():
    return 15
""",
    "solver.py": "def solve(alpha):\n    return alpha + 1\n",
    "figures.py": "WIDTH = 3.5\nHEIGHT = 2.5\n",
    "signals.py": "RATE = 200\n",
}

CACHES = (
    closure._binders,
    known._kept,
    known._path,
    known.source_of,
    source.modules,
    source.path_of,
)


class Package:
    """A package that a test may edit."""

    def __init__(self, folder):
        self.folder = folder / "fprc"

    def fingerprints(self, *roots):
        """Return those of the roots, as a new process would."""
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(fprc, "__path__", [str(self.folder)])
            for cache in CACHES:
                cache.cache_clear()
            found = [fingerprint(root) for root in roots]
        for cache in CACHES:
            cache.cache_clear()
        return found

    def both(self):
        return self.fingerprints(JUDGE, DRAW)

    def write(self, module, text):
        path = self.folder / module
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def edit(self, module, old, new):
        path = self.folder / module
        text = path.read_text(encoding="utf-8")
        assert text.count(old) == 1
        path.write_text(text.replace(old, new), encoding="utf-8")


def small(folder):
    package = Package(folder)
    for name, text in SOURCES.items():
        package.write(name, text)
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
    assert package.both() == original, "read from the cache"
    assert list(package.folder.glob("__pycache__/sources-*.json"))


def test_folder_that_cannot_be_written_to_is_no_error(package, original):
    (package.folder / "__pycache__").write_text("in the way")
    assert package.both() == original


def test_cache_that_is_cut_is_written_anew(package, original):
    package.both()
    (cache,) = package.folder.glob("__pycache__/sources-*.json")
    cache.write_text(cache.read_text()[:200])
    assert package.both() == original
    package.edit("models/linear.py", "alpha < LIMIT", "alpha <= LIMIT")
    assert package.both()[0] != original[0]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("# comment", "# another comment"),
        ('"""Linear model."""', '"""Another sentence."""'),
        ('"""Fit."""', '"""Fit it.\n\n    In two lines.\n    """'),
        ('    """Fit."""\n', ""),
        ('"""A model."""', '"""Another model."""'),
        ('        """Step."""\n', ""),
        ("solver.solve(alpha)", "solver.solve(\n        alpha\n    )"),
    ],
    ids=["comment", "module", "function", "none", "class", "method", "layout"],
)
def test_comments_docstrings_and_layout_do_not_count(package, original, old, new):
    package.edit("models/linear.py", old, new)
    assert package.both() == original


@pytest.mark.parametrize(
    ("module", "old", "new"),
    [
        ("stages/judge.py", "fit(1)", "fit(2)"),
        ("models/linear.py", "alpha < LIMIT", "alpha <= LIMIT"),
        ("models/linear.py", "LIMIT = 0", "LIMIT = 1"),
        ("models/linear.py", "use a larger alpha", "take a larger alpha"),
        ("models/linear.py", "import sin as wave", "import cos as wave"),
        ("models/linear.py", "size = 3", "size = 4"),
        ("models/linear.py", "return self.size", "return 2 * self.size"),
        ("models/linear.py", "    @marked\n", ""),
        ("models/linear.py", "default(1)", "default(2)"),
        ("models/__init__.py", "from fprc.models.linear import Model, fit",
         "from fprc.models.linear import fit\nfrom fprc.models.other import Other as Model"),
        ("solver.py", "alpha + 1", "alpha - 1"),
        ("kinds.py", "value + 11", "value + 1"),
        ("kinds.py", "return function", "return function or None"),
        ("kinds.py", "return 12", "return 2"),
        ("kinds.py", "return 13", "return 3"),
        ("kinds.py", "return 14", "return 4"),
        ("kinds.py", '"b": second', '"c": second'),
    ],
    ids=["itself", "re-exported", "constant", "text that is no docstring", "foreign", "attribute",
         "method", "decorated", "default", "re-export", "imported twice", "of a default",
         "decorator", "in a dict", "in the dict too", "inherited", "dict"],
)  # fmt: skip
def test_code_counts_for_the_stage_that_reaches_it_alone(package, original, module, old, new):
    package.edit(module, old, new)
    judge, draw = package.both()
    assert judge != original[0]
    assert draw == original[1]


@pytest.mark.parametrize(
    ("module", "old", "new"),
    [
        ("stages/judge.py", "return 7", "return 8"),
        ("stages/judge.py", "def unused():", "def more():\n    return 1\n\n\ndef unused():"),
        ("models/other.py", "size = 5", "size = 6"),
        ("kinds.py", "return 15", "return 5"),
        ("figures.py", "HEIGHT = 2.5", "HEIGHT = 2"),
        ("signals.py", "200", "100"),
        ("models/__init__.py", '"Model", "Other"', '"Model"'),
    ],
    ids=["neighbour", "new neighbour", "sibling", "beside", "constant", "unimported", "exports"],
)
def test_code_that_no_name_leads_to_does_not_count(package, original, module, old, new):
    package.edit(module, old, new)
    assert package.both() == original


#: What the drawing stage is given, and an edit elsewhere that must count for it then.
TRICKS = {
    "lazy import": ("    from fprc import signals\n    return signals.RATE", "signals.py", "200"),
    "lazy from": ("    from fprc.signals import RATE\n    return RATE", "signals.py", "200"),
    "relative": ("    from ..signals import RATE\n    return RATE", "signals.py", "200"),
    "long name": ("    import fprc.signals\n    return fprc.signals.RATE", "signals.py", "200"),
    "alias": ("    import fprc.signals as s\n    return s.RATE", "signals.py", "200"),
    "getattr of a module": (
        "    from fprc import signals\n    return getattr(signals, 'RATE')", "signals.py", "200"
    ),
    "vars of a package": (
        "    from fprc import models\n    return vars(models)", "models/other.py", "5"
    ),
    "__dict__": ("    return figures.__dict__", "figures.py", "2.5"),
    "missing name": ("    return figures.MISSING", "figures.py", "2.5"),
    "import_module": (
        "    import importlib\n    return importlib.import_module('fprc.sig' + 'nals')",
        "signals.py", "200",
    ),
    "import_module by name": (
        "    from importlib import import_module as get\n    return get('fprc.signals')",
        "signals.py", "200",
    ),
    "__import__": ("    return __import__('fprc.signals')", "signals.py", "200"),
    "sys.modules": ("    import sys\n    return sys.modules['fprc.signals']", "signals.py", "200"),
    "another Python": ("    import sys\n    return sys.executable, '-m'", "signals.py", "200"),
    "eval": ("    return eval('fi' + 'gures.HEIGHT')", "figures.py", "2.5"),
    "string annotation": (
        "    from fprc.signals import RATE\n    def inner(x: 'RATE'):\n        return x",
        "signals.py", "200",
    ),
}  # fmt: skip


@pytest.mark.parametrize("trick", TRICKS)
def test_roundabout_ways_to_code_count(package, trick):
    body, module, old = TRICKS[trick]
    text = (package.folder / "stages/draw.py").read_text()
    package.write("stages/draw.py", text.replace("    return figures.WIDTH", body))
    before = package.both()
    package.edit(module, old, "1")
    judge, draw = package.both()
    assert judge == before[0]
    assert draw != before[1]


#: Further text of a module that the drawing stage imports, and an edit in it that must count.
ACTING = {
    "call": ("import sys\nsys.setrecursionlimit(999)", "999"),
    "loop": ("for i in range(9):\n    pass", "9"),
    "assignment to another's name": ("import sys\nsys.ours = 77", "77"),
    "registered function": (
        "KNOWN = {}\ndef known(f):\n    KNOWN[f.__name__] = f\n@known\ndef f():\n    return 77",
        "77",
    ),
    "registered by hand": ("KNOWN = {}\ndef f():\n    return 77\nKNOWN['f'] = f", "77"),
    "value of a call": ("import logging\nLOG = logging.getLogger('77')", "77"),
    "class attribute": ("def note(x):\n    return x\nclass A:\n    noted = note(77)", "77"),
    "metaclass": ("class M(type):\n    pass\nclass A(metaclass=M):\n    size = 77", "77"),
    "foreign import": ("import colorsys", "colorsys"),
}


@pytest.mark.parametrize("what", ACTING)
def test_what_acts_by_being_imported_counts(package, original, what):
    text, old = ACTING[what]
    package.write("figures.py", f"WIDTH = 3.5\n{text}\n")
    before = package.both()
    assert before[0] == original[0]
    package.edit("figures.py", old, "calendar" if "import" in what else "78")
    judge, draw = package.both()
    assert judge == before[0]
    assert draw != before[1]


@pytest.mark.parametrize(
    "body",
    [
        "def draw():\n    import fprc.signals\n",
        "import fprc.signals\n\n\ndef draw():\n    return 1\n",
        "from fprc.signals import RATE\n\n\ndef draw():\n    return 1\n",
    ],
    ids=["lazily", "module", "name"],
)
def test_module_that_is_imported_for_its_effect_counts(package, body):
    package.write("stages/draw.py", body)
    package.write("signals.py", "RATE = 200\nfor i in range(9):\n    print(i)\n")
    _, before = package.both()
    package.edit("signals.py", "9", "8")
    assert package.both()[1] != before


def test_star_import_counts_whole(package):
    package.write(
        "stages/draw.py", "from fprc.figures import *\n\n\ndef draw():\n    return WIDTH\n"
    )
    _, before = package.both()
    package.edit("figures.py", "3.5", "3")
    assert package.both()[1] != before


def test_subclasses_that_announce_themselves_make_everything_count(package):
    hook = "class Base:\n    def __init_subclass__(cls):\n        pass\n\nWIDTH = Base\n"
    package.write("figures.py", hook)
    _, before = package.both()
    package.edit("signals.py", "200", "100")
    assert package.both()[1] != before


def test_names_that_lead_in_a_circle_end(package):
    package.write("figures.py", "from fprc.signals import WIDTH\n")
    package.write("signals.py", "from fprc.figures import WIDTH\n")
    assert len(package.both()[1]) == 16


def test_it_counts_which_of_two_known_constants_an_import_binds(package):
    package.write("figures.py", "WIDTH = 3.5\nHEIGHT = 2.0\nBOTH = WIDTH + HEIGHT\n")
    package.write(
        "signals.py", "from fprc.figures import BOTH, WIDTH as size\nRATE = size * BOTH\n"
    )
    before = package.fingerprints("fprc.signals.RATE")
    package.edit("signals.py", "WIDTH as size", "HEIGHT as size")
    assert package.fingerprints("fprc.signals.RATE") != before


def test_what_is_left_out_does_not_count_nor_what_it_alone_leads_to():
    models = {f"fprc.models.{name}" for name in ("esn.ESN", "features.EchoStates")}
    assert models <= reached("fprc.experiments.comparison.judge")
    assert models.isdisjoint(reached("fprc.experiments.comparison.judge", without=models))
    whole = fingerprint("fprc.experiments.comparison.judge")
    assert fingerprint("fprc.experiments.comparison.judge", without=models) != whole


def test_leaving_out_what_is_not_there_is_an_error():
    with pytest.raises(ValueError, match=r"fprc\.models\.ESN: fprc\.models defines no ESN"):
        fingerprint("fprc.experiments.comparison.judge", without=["fprc.models.ESN"])


def test_script_names_what_it_imports(tmp_path):
    script = tmp_path / "script.py"
    script.write_text("import os\nfrom fprc.stages.run import run_stage\nimport fprc.signals\n")
    assert imports_of(script) == ["fprc.signals", "fprc.stages.run.run_stage"]


def test_real_ridge_counts_for_judging_and_not_for_the_readme(tmp_path):
    package = Package(tmp_path)
    shutil.copytree(REAL, package.folder, ignore=shutil.ignore_patterns("__pycache__"))
    stages = "fprc.experiments.comparison.judge", "fprc.stages.documents.update_readme"
    judge, readme = (fingerprint(stage) for stage in stages)
    package.edit("models/ridge.py", "+ alpha * np.eye", "+ 2.0 * alpha * np.eye")
    changed, unchanged = package.fingerprints(*stages)
    assert changed != judge
    assert unchanged == readme


def test_process_that_reads_a_log_counts_what_it_is_given_and_nothing_else():
    found = reached("fprc.stages.preprocess.preprocess")
    assert "fprc.logs.raw.read_raw" in found
    assert "fprc.logs.isolated.run_limited" in found
    assert not [name for name in found if name.startswith(("fprc.cli", "fprc.models"))]
