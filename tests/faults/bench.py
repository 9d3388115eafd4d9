"""The simulated rig behind the fake driver and the fake I2C bus.

In a test the rig runs on the test's clock; as a program, ``python bench.py FILE``, it runs in
real time and prints ``ready`` once it does.
"""

import ctypes
import mmap
import os
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

from fprc.apparatus.journal import read_journal
from fprc.config import Settings
from fprc.devices.sim import SimulatedRig

FOLDER = Path(__file__).parent
LOGGED = 65536
#: Boards of this process alone: other tests, and a rig, may run beside it on this computer.
BOARDS = {"input_device": f"AIO000-{os.getpid()}", "output_device": f"AIO001-{os.getpid()}"}
_COUNTS = (
    "calls", "fail_at", "fail_count", "fail_code", "failures", "writes", "stall_us", "init_us",
    "opened",
)  # fmt: skip


class Layout(ctypes.Structure):
    """As in fake_caio.c."""

    _fields_ = (
        ("inputs", ctypes.c_double * 16),
        ("outputs", ctypes.c_double * 16),
        *((name, ctypes.c_int64) for name in _COUNTS),
        ("angles", ctypes.c_double * 2),
        ("i2c_fault", ctypes.c_int64),
        ("failed", ctypes.c_char * 32),
        ("log", (ctypes.c_double * 3) * LOGGED),
    )

    def fail(self, count=1, skip=0, code=777):
        """Let calls of the driver fail after the next ``skip``."""
        self.fail_at, self.fail_count, self.fail_code = self.calls + 1 + skip, count, code

    def logged(self):
        """Return time, channel and voltage of every write to the output board."""
        assert self.writes <= LOGGED, "the log of writes is a ring; make the run shorter"
        return [(row[0], int(row[1]), row[2]) for row in self.log[: self.writes]]


def compile_driver(folder: Path) -> Path:
    """Build the fake libcaio.so with the system's compiler."""
    library = folder / "libcaio.so"
    flags = ["-shared", "-fPIC", "-O2", "-Wall", "-Wextra", "-Werror"]
    subprocess.run(["cc", *flags, "-o", library, FOLDER / "fake_caio.c"], check=True)
    return library


def journal_at(path):
    """Return what a journal holds, and what it says of the end of its run."""
    channels, attributes, closed = read_journal(path)
    found = SimpleNamespace(channels=channels, attributes=attributes, closed=closed)
    found.samples, found.lost = len(next(iter(channels.values()))), attributes["lost_samples"]
    found.reason = attributes.get("incomplete_reason", "")
    return found


def mapped(path):
    """Return the shared memory in a file."""
    with path.open("r+b") as file:
        return Layout.from_buffer(mmap.mmap(file.fileno(), 0))


class Bench:
    """Simulated rig wired to the shared memory that the fake driver and the fake bus use.

    It is a clock too: its time passes in ``wait_for``.
    """

    def __init__(self, path: Path, settings: dict, *, seed: int = 1, run: int = 0):
        path.write_bytes(bytes(ctypes.sizeof(Layout)))
        self.shared = mapped(path)
        self.fail, self.writes = self.shared.fail, self.shared.logged
        rate_hz = settings["control"]["sample_rate_hz"]
        self.period_s, self.tick = 1.0 / rate_hz, 0
        self.rig = SimulatedRig(settings["rig"], seed=seed, run=run, sample_rate_hz=rate_hz)
        self._transducers = [settings["hardware"][name] for name in ("p_exp", "p_i", "p_o")]
        self._show()

    def elapsed(self) -> float:
        return self.tick * self.period_s

    def wait_for(self, tick: int) -> int:
        """Simulate up to this tick with the voltages on the output board."""
        self.rig.write(*self.shared.outputs[:2])
        self.rig.wait_for(tick)
        self.tick = tick
        self._show()
        return tick

    def wait(self, seconds: float) -> None:
        """Simulate the rig for this time."""
        self.wait_for(self.tick + round(seconds / self.period_s))

    def statistics(self) -> dict:
        return {"ticks": self.tick + 1, "overruns": 0}

    def _show(self) -> None:
        now = self.rig.read()
        pressures = (now.p_exp_kpa, now.p_i_kpa, now.p_o_kpa)
        for channel, (kpa, own) in enumerate(zip(pressures, self._transducers, strict=True)):
            self.shared.inputs[channel] = kpa / own["gain_kpa_per_v"] + own["zero_v"]
        self.shared.angles[:] = [now.theta_deg, now.phi_deg]


def main() -> None:
    bench = Bench(Path(sys.argv[1]), Settings().model_dump())
    bench.wait_for(1)
    print("ready", flush=True)
    start_s, parent = time.perf_counter(), os.getppid()
    while os.getppid() == parent:
        bench.wait_for(1 + int((time.perf_counter() - start_s) / bench.period_s))
        time.sleep(0.5 * bench.period_s)


if __name__ == "__main__":
    main()
