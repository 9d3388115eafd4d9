"""A process that is killed loses no sample that it has appended."""

import random
import signal
import subprocess
import sys

import numpy as np
import pytest

from fprc.channels import RAW_CHANNELS
from fprc.logs import read_journal

#: Child process: appends as fast as it can and says after each sample how many there are.
APPEND = """
import sys
from fprc.channels import RAW_CHANNELS
from fprc.logs import Journal

attributes = {
    "experiment": "sweep", "source": "rig", "sample_rate_hz": 200.0, "seed": 0,
    "software": "test", "rig": {},
}
journal = Journal(sys.argv[1], RAW_CHANNELS, attributes, sync_s=0.01)
k = 0
while True:
    journal.append(k, [k / 200.0] + [float(k)] * (len(RAW_CHANNELS) - 1))
    k += 1
    print(k, flush=True)
"""


@pytest.mark.parametrize("seed", range(5))
def test_samples_appended_before_a_kill_are_all_there(tmp_path, seed):
    path = tmp_path / "run.journal"
    command = [sys.executable, "-c", APPEND, str(path)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    # so many lines later, wherever the child is then
    for _ in range(random.Random(seed).randrange(1, 20_000)):
        reported = process.stdout.readline()
    process.send_signal(signal.SIGKILL)
    rest = process.stdout.read().split("\n")
    process.wait()
    process.stdout.close()
    assert process.returncode == -signal.SIGKILL
    reported = int(rest[-2] if len(rest) > 1 else reported)
    channels, _, findings = read_journal(path)
    expected = np.arange(findings.samples, dtype=np.float64)
    np.testing.assert_array_equal(channels["time_s"], expected / 200.0)
    for name in RAW_CHANNELS[1:]:
        np.testing.assert_array_equal(channels[name], expected)
    # one more may have been written and not reported, or be there in part
    assert reported <= findings.samples <= reported + 1
    assert findings.lost <= 1
    assert not findings.closed
    assert not findings.complete
    assert findings.reason.startswith("not closed: ")
