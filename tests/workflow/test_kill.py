"""Killed in the middle of a sweep, the workflow goes on where it was."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

pytestmark = pytest.mark.slow


def finished_cells(checkpoint):
    try:
        return checkpoint.read_text(encoding="utf-8").splitlines()[1:]
    except FileNotFoundError:
        return []


def test_sweep_that_was_killed_goes_on_at_its_next_cell(smoked, smoked_copy):
    results = smoked_copy.folder / "results/smoke"
    expected = (results / "sweeps/taps.json").read_bytes()
    (results / "sweeps/taps.json").unlink()
    checkpoint = results / "sweeps/taps.partial.jsonl"
    command = [sys.executable, "-m", "snakemake", "--cores", "1", "fig11", "--configfile"]
    process = subprocess.Popen(
        [*command, "config/smoke.yaml"],
        cwd=smoked_copy.folder,
        env=os.environ | {"PATH": f"{os.path.dirname(sys.executable)}:{os.environ['PATH']}"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    deadline = time.monotonic() + 120
    while not (before := finished_cells(checkpoint)) and time.monotonic() < deadline:
        time.sleep(0.005)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    assert before, "no cell was finished in time"
    assert not (results / "sweeps/taps.json").exists()
    kept = [json.loads(line)["cell"] for line in finished_cells(checkpoint)]
    assert 1 <= len(kept) < 4

    assert smoked_copy.smoke("--unlock").returncode == 0
    done = smoked_copy.smoke("fig11")
    assert done.returncode == 0, done.stdout
    assert "Sweep over taps" in done.stdout
    computed = done.stdout.count("of 4 cells")
    assert computed == 4 - len(kept)
    assert (results / "sweeps/taps.json").read_bytes() == expected
    assert not checkpoint.exists()
