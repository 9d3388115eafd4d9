import re
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parent / "benchmark_loop.py"


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the stand-ins need Linux")
def test_benchmark_prints_overruns_and_percentiles():
    said = subprocess.run(
        [sys.executable, SCRIPT, "--seconds", "1", "--priority", "0"],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    samples, planned, overruns = map(
        int, re.search(r"(\d+) samples of (\d+), (\d+) overruns", said).groups()
    )
    assert planned == 200
    # the last sample may be so late that it overruns the end
    assert samples <= planned <= samples + overruns
    late = [float(ms) for ms in re.findall(r"late by +([\d.]+) ms, ", said)]
    assert len(late) == 4
    assert late == sorted(late)
    assert re.search(r"\d+ processors, load average", said)
