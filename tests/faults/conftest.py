"""The table of docs/faults.md: tests add rows to it, and the page must contain the same rows."""

import sys
from pathlib import Path
from typing import NamedTuple

import pytest

from fprc.studies.blocks import replace_block

PAGE = Path(__file__).parents[2] / "docs" / "faults.md"
_COLUMNS = ("fault", "where", "runs", "what ends the run", "safe", "ticks", "lost", "measured")


class Row(NamedTuple):
    """Outcome of a fault."""

    fault: str
    where: str
    ends: str
    safe: str
    ticks: str
    lost: str


class Matrix:
    """Rows of this session, in the order of the tests."""

    def __init__(self):
        self.rows: dict[Row, int] = {}
        self.measured: dict[Row, str] = {}

    def add(self, *cells, measured=""):
        """Add the outcome of one fault at one place."""
        row = Row(*map(str, cells))
        self.rows[row] = self.rows.get(row, 0) + 1
        self.measured[row] = measured

    def lines(self):
        """Return the table, one row for each outcome of a device's faults, or of one fault."""
        groups: dict[Row, list[Row]] = {}
        for row in self.rows:
            groups.setdefault(self._group(row), []).append(row)
        return _lines([_COLUMNS, ("---",) * len(_COLUMNS), *map(self._cells, groups.values())])

    def _group(self, row):
        device, colon, _ = row.fault.rpartition(": ")
        if self.measured[row]:
            return row
        return row._replace(fault=device) if colon else row._replace(where="")

    def _cells(self, rows):
        first, runs = rows[0], [self.rows[row] for row in rows]
        device, colon, _ = first.fault.rpartition(": ")
        fault, where = first.fault, first.where
        if colon:
            fault = device + colon + "; ".join(row.fault.rpartition(": ")[2] for row in rows)
        elif len(rows) > 1:
            where = "; ".join(f"{row.where} ({n})" for row, n in zip(rows, runs, strict=True))
        return (fault, where, str(sum(runs)), *first[2:], self.measured[first])


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
def matrix(_matrix):
    """The table to add to."""
    if not sys.platform.startswith("linux"):
        pytest.skip("the stand-ins need Linux")
    return _matrix


_passed: set[str] = set()


def pytest_runtest_logreport(report):
    if report.when == "call" and report.passed:
        _passed.add(report.nodeid)


_FILLING = {"test_matrix.py", "test_process.py"}


@pytest.fixture
def whole_matrix(_matrix, request):
    """The table after every test has added to it; skips if some did not run."""
    # other folders have fixtures of these names too
    here = [item for item in request.session.items if item.path.parent == Path(__file__).parent]
    present = {item.path.name for item in here}
    filling = {item.nodeid for item in here if "matrix" in item.fixturenames}
    chosen = request.config.option.keyword or request.config.option.markexpr
    if not present >= _FILLING or chosen or not filling <= _passed:
        pytest.skip("not every test of the table was run")
    return "\n".join(_matrix.lines())


@pytest.fixture
def page(request, whole_matrix):
    """The page as committed; its table is written first if requested."""
    text = PAGE.read_text(encoding="utf-8")
    if request.config.getoption("write_matrix", False):
        text = replace_block(text, "faults", whole_matrix, PAGE.name)
        PAGE.write_text(text, encoding="utf-8")
    return text
