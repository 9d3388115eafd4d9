"""Import the modules of the fuzzing program by their plain names, as the program does."""

import sys
from pathlib import Path

import pytest

FUZZ = Path(__file__).parent


@pytest.fixture(scope="session", autouse=True)
def _modules():
    """Find the program's modules in this session, and leave none of their names behind."""
    sys.path.insert(0, str(FUZZ))
    yield
    sys.path.remove(str(FUZZ))
    for path in FUZZ.glob("*.py"):
        sys.modules.pop(path.stem, None)
