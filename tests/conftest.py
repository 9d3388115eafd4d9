"""The fake driver, and a simulated rig wired to it."""

import importlib
import os
import shutil
import sys
from pathlib import Path

import pytest

from fprc.config import Settings

FAULTS = Path(__file__).parent / "faults"
_MODULES = ("bench", "fake_bus", "smbus2")


@pytest.fixture(scope="session")
def compiled_driver(tmp_path_factory):
    """The fake driver's shared library."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(FAULTS))
        bench = importlib.import_module("bench")
        _forget()
    return bench.compile_driver(tmp_path_factory.mktemp("driver"))


@pytest.fixture
def driver(compiled_driver, tmp_path):
    """A copy of the library for this test alone: a loaded library keeps its bench."""
    return Path(shutil.copy(compiled_driver, tmp_path))


@pytest.fixture
def settings(driver):
    """Default settings of a rig behind the fake driver."""
    found = Settings().model_dump(mode="json")
    found["hardware"]["boards"]["library"] = str(driver)
    return found


@pytest.fixture
def make_bench(tmp_path, monkeypatch):
    """Return what builds the simulated rig behind the fake driver, once in a test."""
    monkeypatch.syspath_prepend(str(FAULTS))
    _forget()
    monkeypatch.setenv("FAKE_BENCH", str(tmp_path / "bench"))

    def make(settings, **more):
        return importlib.import_module("bench").Bench(
            Path(os.environ["FAKE_BENCH"]), settings, **more
        )

    yield make
    _forget()


@pytest.fixture
def bench(make_bench, settings):
    """Simulated rig of the default settings behind the fake driver."""
    return make_bench(settings)


def _forget():
    for name in _MODULES:
        sys.modules.pop(name, None)
