"""The table of docs/hardware.md: tests add rows to it, and the page must contain the same rows."""

import sys

import pytest

_HEAD = ("fault", "runs", "what ends the run", "safe", "ticks", "lost", "measured")


class Matrix:
    """Rows of this session, in the order of the tests."""

    def __init__(self):
        self.rows = {}

    def add(self, fault, ends, safe="yes", ticks="-", lost=0, measured=""):
        """Add the outcome of one fault at one place."""
        row = tuple(map(str, (fault, ends, safe, ticks, lost)))
        runs, _ = self.rows.get(row, (0, ""))
        self.rows[row] = runs + 1, measured

    def text(self):
        """Return the table."""
        found = [(row[0], str(runs), *row[1:], ms) for row, (runs, ms) in self.rows.items()]
        table = [_HEAD, ("---",) * len(_HEAD), *found]
        return "\n".join(f"| {' | '.join(cells)} |" for cells in table)


def pytest_addoption(parser):
    parser.addoption("--write-matrix", action="store_true", help="write docs/hardware.md")


@pytest.fixture(scope="session")
def _matrix():
    return Matrix()


@pytest.fixture
def matrix(_matrix):
    """The table to add to."""
    if not sys.platform.startswith("linux"):
        pytest.skip("the stand-ins need Linux")
    return _matrix


@pytest.fixture
def whole_matrix(_matrix, request):
    """The table after every test has added to it; skips if some did not run, or failed."""
    ran = {item.path.name for item in request.session.items}
    chosen = request.config.option.keyword or request.config.option.markexpr
    if chosen or request.session.testsfailed or not ran >= {"test_matrix.py", "test_process.py"}:
        pytest.skip("not every test of the table was run")
    return _matrix.text()
