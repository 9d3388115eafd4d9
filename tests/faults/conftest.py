"""The fault matrix: tests put rows into it; docs/faults.md must hold the same."""

import sys
from pathlib import Path
from typing import NamedTuple

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "faults.md"
_HEAD = """\
# What happens when something fails

Written by the tests: `make fault-matrix`. Another test fails when a column but the last differs
from what it finds.

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

    def lines(self, measured=True):
        """Return the table; without what is measured for a comparison."""
        table = [_COLUMNS, ("---",) * len(_COLUMNS)]
        for row, places in self.rows.items():
            last = self.measured[row] if measured else ""
            table.append((row.fault, row.where, str(places), *row[2:6], last))
        return [f"| {' | '.join(cells)} |" for cells in table]


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


_passed: set[str] = set()


@pytest.fixture
def whole_matrix(_matrix, request):
    """The table once every test has added to it; else the test is skipped."""
    files = {item.path.name for item in request.session.items}
    filling = {i.nodeid for i in request.session.items if "matrix" in i.fixturenames}
    chosen = request.config.option.keyword or request.config.option.markexpr
    if not {"test_matrix.py", "test_process.py"} <= files or chosen or filling != _passed:
        pytest.skip("not every test of the matrix was run")
    return _matrix


@pytest.fixture
def page(request, whole_matrix):
    """Lines of the table as committed; written first if that was asked for."""
    if request.config.getoption("write_matrix", False):
        PAGE.write_text(_HEAD + "\n".join(whole_matrix.lines()) + "\n", encoding="utf-8")
    text = PAGE.read_text(encoding="utf-8") if PAGE.exists() else ""
    assert text.startswith(_HEAD), "run `make fault-matrix`"
    return text[len(_HEAD) :].splitlines()
