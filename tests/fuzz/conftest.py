"""A folder in which commands run on damaged files, with limits on time and memory."""

import io
import re
import resource
import signal
import warnings
from contextlib import chdir, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import NamedTuple

import pytest

from fprc.cli import main

#: Limits of one command: wall-clock time, and memory beside what the libraries have taken.
LIMIT_S, LIMIT_BYTES = 60, 2 << 30

#: Control characters of a terminal; a warning of a library; a traceback; a number that is none.
_FORBIDDEN = re.compile(
    r"[\x00-\x08\x0b-\x1f\x7f-\x9f\udc80-\udcff]|^.*\b\w*Warning: .*$"
    r"|Traceback \(most recent|[:\[,]\s*-?(NaN|Infinity)\b",
    re.MULTILINE,
)


class Ended(NamedTuple):
    """Exit code and output of a command."""

    code: int
    out: str


class Bench:
    """A folder in which commands run on the same files again and again."""

    def __init__(self, folder):
        self.folder = folder

    def put(self, **files):
        """Empty the folder, and write files: ``log_h5`` is ``log.h5``."""
        for path in self.folder.iterdir():
            path.unlink()
        for name, data in files.items():
            (self.folder / name.replace("_", ".")).write_bytes(data)

    def run(self, *command, names, writes=(), accepted=lambda ended: ended.code == 0):
        """Run ``fprc``; return how it ended if it accepted the file, and None if it refused it.

        Whatever it does, it changes no file, prints nothing that a person must not see, and is done
        in time. A refusal names one of ``names`` and leaves no file; ``writes`` are those that it
        may write otherwise.
        """
        before = self._content()
        ended = self._call(command)
        how = f"{' '.join(command)}: {ended}"
        assert not _FORBIDDEN.search(ended.out), how
        after = self._content()
        assert {name: after.get(name) for name in before} == before, how
        done = accepted(ended)
        assert after.keys() - before.keys() <= set(writes if done else ()), how
        assert done or any(name in ended.out for name in names), how
        return ended if done else None

    def _content(self):
        return {path.name: path.read_bytes() for path in self.folder.iterdir()}

    def _call(self, command):
        said = io.StringIO()
        signal.alarm(LIMIT_S)
        try:
            with (
                chdir(self.folder), redirect_stdout(said), redirect_stderr(said),
                warnings.catch_warnings(),
            ):  # fmt: skip
                warnings.simplefilter("always", RuntimeWarning)
                code = main(list(command))
        except SystemExit as end:
            code = end.code
        finally:
            signal.alarm(0)
        return Ended(code or 0, said.getvalue())


# of a module: other tests of the same process, and what they start, need more memory
@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """Yield the folder, with limits on the memory and the time of each command."""

    def late(*_):
        raise TimeoutError(f"not done in {LIMIT_S} s")

    taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (taken + LIMIT_BYTES, hard))
    handler = signal.signal(signal.SIGALRM, late)
    yield Bench(tmp_path_factory.mktemp("bench"))
    signal.signal(signal.SIGALRM, handler)
    resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
