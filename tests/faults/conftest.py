"""The tables of docs/faults.md: tests add rows to them, and the page must contain the same rows."""

import importlib.util
import re
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "faults.md"
_HEAD = """\
# What happens when something fails

Written by the tests: `make fault-matrix`. Another test fails when a column but *measured* differs
from what it finds.

`make fuzz` tries some thousand files more, damaged at random: configurations, logs, recordings and
journals; `make fuzz CASES=500 SEED=2` fewer and others. It counts what comes of them, and keeps the
files of those that end as they must not.

## The real rig

The real devices' code runs with a stand-in for Contec's driver, a C library with the same symbols,
and one for the bus of the angle sensors; behind both is the simulated rig. **Nothing of this was
tried on hardware.**

- *places*: how many there are, each tried in a run of its own
- *safe*: the last voltages on the output board vent both chambers
- *ticks*: those that began between the fault and the writes that vent; 0: in the fault's tick
- *lost*: samples that were read and written to the valves and are not in the journal afterwards
- *measured*: faults of a process happen in real time; this is the time from the fault to the last
  of the writes that vent, on the computer that wrote this page

"""
_FILES_HEAD = """\

## Files and settings

Each fault is made by a test in `tests/faults/test_files.py`, and given to the command as a user
would.

- *what comes of it*: what comes out, or what is named by the message of a command that ends with 1
- *left behind*: what is there afterwards that was not there before

"""
_FILES_COLUMNS = ("fault", "command", "what comes of it", "exit code", "left behind")
_COLUMNS = ("fault", "where", "places", "what ends the run", "safe", "ticks", "lost", "measured")


class Row(NamedTuple):
    """What came of a fault; ``measured`` is not compared."""

    fault: str
    where: str
    ends: str
    safe: str
    ticks: str
    lost: str
    measured: str = ""


class Matrix:
    """Rows of this session, in the order of the tests."""

    def __init__(self):
        self.rows: dict[Row, int] = {}
        self.measured: dict[Row, str] = {}
        self.complete = False

    def add(self, *cells, measured=""):
        """Add what came of one fault at one place."""
        row = Row(*map(str, cells))
        self.rows[row] = self.rows.get(row, 0) + 1
        self.measured[row] = measured

    def lines(self):
        """Return the table."""
        table = [_COLUMNS, ("---",) * len(_COLUMNS)]
        for row, places in self.rows.items():
            table.append((row.fault, row.where, str(places), *row[2:6], self.measured[row]))
        return _lines(table)


class Files:
    """What came of files and settings, in the order of the tests."""

    def __init__(self):
        self.rows: dict[tuple[str, ...], None] = {}

    def add(self, *cells):
        """Add what came of one fault; the same row is there once."""
        self.rows[tuple(map(str, cells))] = None

    def lines(self):
        """Return the table."""
        return _lines([_FILES_COLUMNS, ("---",) * len(_FILES_COLUMNS), *self.rows])


def _lines(table):
    # a bar would end a cell
    return [f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |" for row in table]


def pytest_addoption(parser):
    parser.addoption("--write-matrix", action="store_true", help=f"write {PAGE.name}")


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items):
    # the table is compared when everything else has filled it
    items.sort(key=lambda item: "whole_matrix" in item.fixturenames)


@pytest.fixture(scope="session")
def _matrix():
    return Matrix()


@pytest.fixture
def matrix(_matrix, request):
    """The table to add to."""
    if not sys.platform.startswith("linux"):
        pytest.skip("the stand-ins need Linux")
    yield _matrix
    _passed.add(request.node.nodeid)


@pytest.fixture(scope="session")
def _files():
    return Files()


@pytest.fixture
def files(_files, request):
    """The table of files and settings, to add to."""
    yield _files
    _passed.add(request.node.nodeid)


_passed: set[str] = set()
_FILLING = {"test_matrix.py", "test_process.py", "test_files.py"}


@pytest.fixture
def whole_matrix(_matrix, _files, request):
    """The page once every test has added to it; else the test is skipped."""
    # other folders have fixtures of these names too
    here = [item for item in request.session.items if item.path.parent == Path(__file__).parent]
    present = {item.path.name for item in here}
    filling = {item.nodeid for item in here if {"matrix", "files"} & {*item.fixturenames}}
    chosen = request.config.option.keyword or request.config.option.markexpr
    if not present >= _FILLING or chosen or filling != _passed:
        pytest.skip("not every test of the tables was run")
    return "\n".join([_HEAD + "\n".join(_matrix.lines()), _FILES_HEAD + "\n".join(_files.lines())])


@pytest.fixture
def page(request, whole_matrix):
    """The page as committed; written first if that was asked for."""
    if request.config.getoption("write_matrix", False):
        PAGE.write_text(whole_matrix + "\n", encoding="utf-8")
    return PAGE.read_text(encoding="utf-8") if PAGE.exists() else ""


# --- files and settings ---------------------------------------------------------------------

_COMMAND = [sys.executable, "-c", "import sys; from fprc.cli import main; sys.exit(main())"]
#: Longest time that a command may take on a busy machine; what hangs takes longer.
_PATIENCE_S = 60.0
_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f]")


def _of_fuzz(name):
    path = Path(__file__).parents[1] / "fuzz" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"fuzz_{name}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def signals():
    """Channels of logs with which nothing is wrong."""
    return _of_fuzz("signals")


class Said(NamedTuple):
    """What came of a command: exit code, what was printed, files that are new."""

    code: int
    text: str
    left: list[str]

    def refuses(self, **named):
        """Check that the command refused, named these things, and left nothing; say so."""
        assert self.code not in (0, 3), self.text
        for what, word in named.items():
            assert re.search(word, self.text), f"{what} is not named: {self.text}"
        assert not self.left
        return f"a message that names {', '.join(named)}"


class User:
    """Somebody in a folder, who types commands."""

    def __init__(self, folder, capfd):
        self.folder = folder
        self._capfd = capfd

    def types(self, *command):
        """Run ``fprc`` in this process."""
        from fprc.cli import main

        before = self._there()
        self._capfd.readouterr()
        try:
            code = main(command)
        except SystemExit as end:
            code = end.code
        return self._said(code, "".join(self._capfd.readouterr()), before)

    def starts(self, *command, program=_COMMAND, folder=None, **environment):
        """Run it in a process of its own, with limits on its time and its memory."""
        watched = _of_fuzz("watched")
        before = self._there()
        ended = watched.command(
            [*program, *command], folder or self.folder, environment=environment,
            limit_s=_PATIENCE_S,
        )  # fmt: skip
        assert not ended.stopped, f"{command}: stopped for its {ended.stopped}"
        assert ended.code >= 0, f"{command}: ended by signal {-ended.code}"
        assert ended.peak_bytes < watched.LIMIT_BYTES
        return self._said(ended.code, ended.out + ended.err, before)

    def _said(self, code, text, before):
        assert "Traceback" not in text
        assert not _CONTROL.search(text), f"{text!r}"
        return Said(code, text, sorted(self._there() - before))

    def _there(self):
        return {str(path.relative_to(self.folder)) for path in self.folder.rglob("*")}


@pytest.fixture
def user(tmp_path, monkeypatch, capfd):
    """Somebody in a folder of the test's own."""
    folder = tmp_path / "user"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return User(folder, capfd)
