"""Import the modules of the fuzzing program by their plain names, as the program does."""

import sys
from pathlib import Path

import pytest

FUZZ = Path(__file__).parent


@pytest.fixture(scope="session", autouse=True)
def _modules():
    """Make the program's modules importable during this session only."""
    sys.path.insert(0, str(FUZZ))
    yield
    sys.path.remove(str(FUZZ))
    for path in FUZZ.glob("*.py"):
        sys.modules.pop(path.stem, None)
