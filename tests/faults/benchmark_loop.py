"""Measure the lateness of the loop on this computer. Run by `make loop-benchmark`.

`fprc rig run` uses the fake driver; its simulated rig runs in another process. Prints overruns
and the delays of the ticks.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

FOLDER = Path(__file__).parent
sys.path.insert(0, str(FOLDER))

from bench import BOARDS, compile_driver  # noqa: E402

from fprc.apparatus.record_on_rig import record_on_rig  # noqa: E402
from fprc.apparatus.recovery import read_journal  # noqa: E402
from fprc.config import Settings  # noqa: E402


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="default: %(default)g")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        measured = measure(Path(name), options.seconds)
    load = ", ".join(f"{value:.1f}" for value in os.getloadavg())
    print(f"{os.cpu_count()} processors, load average {load}")
    print(
        f"{measured['samples']} samples of {measured['planned']}, {measured['overruns']} overruns"
    )
    for key, what in (
        ("jitter_p50_s", "50 %"),
        ("jitter_p99_s", "99 %"),
        ("jitter_p99_9_s", "99.9 %"),
        ("jitter_max_s", "at most"),
    ):
        print(f"late by {1e3 * measured[key]:8.3f} ms, {what}")


def measure(folder: Path, seconds: float) -> dict:
    """Return a run's clock statistics, with the samples ``planned`` and recorded."""
    settings = Settings().model_dump(mode="json")
    settings["experiments"]["sweep"]["duration_s"] = seconds
    hardware = settings["hardware"]
    hardware["boards"] |= {"library": str(compile_driver(folder)), **BOARDS}
    # a busy computer must not end the run: its lateness is measured
    hardware["loop"]["stalled_s"] = hardware["limits"]["stale_s"] = 10.0
    hardware["limits"] |= {"overruns_in_a_row": 1000, "pressure_step_kpa": 1000.0}
    modules = os.pathsep.join(filter(None, [str(FOLDER), os.environ.get("PYTHONPATH")]))
    os.environ |= {"FAKE_BENCH": str(folder / "bench"), "PYTHONPATH": modules}
    bench = [sys.executable, FOLDER / "bench.py", folder / "bench"]
    with subprocess.Popen(bench, stdout=subprocess.PIPE) as rig:
        try:
            rig.stdout.readline()
            record_on_rig(str(folder / "sweep.h5"), name="sweep", settings=settings, armed=True)
        finally:
            rig.terminate()
    (journal,) = folder.glob("*.journal")
    _, _, findings = read_journal(journal)
    planned = round(seconds * settings["control"]["sample_rate_hz"])
    return findings.statistics | {"samples": findings.samples, "planned": planned}


if __name__ == "__main__":
    main()
