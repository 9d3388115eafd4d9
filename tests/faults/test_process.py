"""Faults of processes, in real time: ``fprc rig`` itself, with the rig in another process.

No time is asserted. The driver prints, as some do, which must not pass for a message of the loop.
"""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from bench import BOARDS, journal_at, mapped

from fprc.channels import RAW_CHANNELS
from fprc.logs import read_raw

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="looks for processes in /proc"),
]
FOLDER = Path(__file__).parent
PATIENCE_S = 120.0
# on a busy machine, only the tested fault may end a run
LIMITS = {"overruns_in_a_row": 1000, "stale_s": 10.0, "pressure_step_kpa": 1000.0}
VENTED = [(0, 0.0), (1, 0.0)]
VENTED_AS_SHOWN = "both chambers are vented, as their sensors show"
HOUR_US = 3_600_000_000


def wait_until(true, what):
    end_s = time.monotonic() + PATIENCE_S
    while not (found := true()):
        assert time.monotonic() < end_s, f"waited in vain for {what}"
        time.sleep(0.002)
    return found


def environment(path):
    modules = os.pathsep.join(filter(None, [str(FOLDER), os.environ.get("PYTHONPATH")]))
    return os.environ | {"FAKE_BENCH": str(path), "FAKE_CHATTY": "1", "PYTHONPATH": modules}


@pytest.fixture(scope="module")
def shared(tmp_path_factory, compiled_driver):
    """Memory of a rig that runs in a separate process during the tests of this module."""
    path = tmp_path_factory.mktemp("bench") / "bench"
    with subprocess.Popen(
        [sys.executable, FOLDER / "bench.py", path], stdout=subprocess.PIPE, env=environment(path)
    ) as rig:
        assert rig.stdout.readline() == b"ready\n"
        layout = mapped(path)
        layout.path = path
        yield layout
        rig.terminate()


@pytest.fixture
def rig(shared):
    """The memory, reset after the previous test."""
    for name in ("calls", "fail_at", "failures", "writes", "stall_us", "init_us", "opened",
                 "i2c_fault"):  # fmt: skip
        setattr(shared, name, 0)
    shared.outputs[:2] = [0.0, 0.0]
    return shared


def hear():
    """Restore the signals that nohup, or a background shell, ignores."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


class Program:
    """``fprc rig`` in a separate session, as started from a terminal in ``folder``."""

    def __init__(self, rig, folder, driver, verb, *, seconds=10.0, **hardware):
        self.rig, self.raw = rig, folder / "raw" / "sweep.h5"
        own = {
            "boards": {"library": str(driver)} | BOARDS,
            "limits": LIMITS,
            "loop": {"stalled_s": 10.0},
        }
        own |= {name: own.get(name, {}) | given for name, given in hardware.items()}
        sweep = {"duration_s": seconds, "amplitude_kpa": 50.0, "offset_kpa": 50.0}
        config = folder / "bench.yaml"
        config.write_text(json.dumps({"experiments": {"sweep": sweep}, "hardware": own}))
        command = [
            "-c",
            "import sys; from fprc.cli import main; sys.exit(main())",
            "rig",
            *verb,
            "--armed",
        ]
        command += ["--out", str(self.raw)] if verb[0] == "run" else []
        self.process = subprocess.Popen(
            [sys.executable, *command, "--config", str(config)],
            env=environment(rig.path),
            cwd=folder,
            stderr=subprocess.PIPE,
            start_new_session=True,
            preexec_fn=hear,
        )

    def is_in_mid_run(self):
        wait_until(lambda: self.rig.writes > 60 or self.process.poll() is not None, "the run")
        assert self.process.poll() is None, self.process.stderr.read().decode()

    def loop(self):
        """Return the number of the process that drives the rig."""
        children = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children")
        (child,) = children.read_text().split()
        return int(child)

    def end(self):
        """Wait for the end of both processes; return exit code and output."""
        # the pipe ends with the last process that holds it
        _, output = self.process.communicate(timeout=PATIENCE_S)
        return self.process.returncode, output.decode()

    def journal(self):
        (path,) = self.raw.parent.glob("*.journal")
        return journal_at(path)

    def ended_vented(self, samples, lost=0):
        """Check that the last writes vented, and how many samples at most are in no file."""
        rows = [row[1:] for row in self.rig.logged()]
        assert rows[:2] == rows[-2:] == VENTED
        assert list(self.rig.outputs[:2]) == [0.0, 0.0]
        end = next(k for k in range(len(rows), 2, -1) if rows[k - 1][1] not in (0.0, 5.0))
        # a sample is complete once both valves are written; the journal gets it just after
        assert samples >= 20
        assert 0 <= (end - 2) // 2 - samples <= lost


@pytest.fixture
def start(rig, tmp_path, compiled_driver):
    """Start ``fprc rig``; ended with the test."""
    started = []

    def start(*verb, **more):
        started.append(Program(rig, tmp_path, compiled_driver, verb, **more))
        return started[-1]

    yield start
    for program in started:
        if program.process.poll() is None:
            program.process.kill()
        program.process.communicate()


def test_run_that_ends_well_leaves_a_log_that_can_be_read(start, rig):
    program = start("run", "sweep", seconds=1.0)
    code, output = program.end()
    assert code == 0, output
    findings = program.journal()
    overruns = findings.attributes["statistics"]["overruns"]
    assert findings.reason == ""
    # on a busy machine, the last ticks that were missed may be beyond the end
    assert findings.samples <= 200 <= findings.samples + overruns
    log = read_raw(program.raw, experiment="sweep", sample_rate_hz=200.0, rate_tolerance=0.9)
    assert set(log.channels) == set(RAW_CHANNELS)
    for name, values in log.channels.items():
        assert np.array_equal(values, findings.channels[name])
    assert (log.attributes["source"], findings.attributes["source"]) == ("rig", "rig")
    assert np.ptp(log.channels["p_exp_kpa"]) > 50.0
    assert rig.opened == 0
    valves = [log.channels[name].astype("f4") for name in ("valve_main_v", "valve_reservoir_v")]
    written = [row for pair in zip(*valves, strict=True) for row in enumerate(pair)]
    rows = [row[1:] for row in rig.logged()]
    end = VENTED * (len(rows) // 2 - len(written) // 2 - 2)
    assert end
    assert rows == VENTED + written + [(0, 5.0), (1, 5.0)] + end


def send(name, *, loop=False, group=False):
    """Return what sends a signal to the guardian, to its group, or to the loop."""

    def happen(program):
        number = program.loop() if loop else program.process.pid
        (os.killpg if group else os.kill)(number, getattr(signal, name))

    return happen


def wait_until_vented(program):
    wait_until(lambda: list(program.rig.outputs[:2]) == [0.0, 0.0], "the valves")


def a_reading_hangs(program):
    """The guardian's own reading hangs too, until the user gives up."""
    program.rig.stall_us = HOUR_US
    wait_until_vented(program)
    calls = program.rig.calls
    os.kill(program.process.pid, signal.SIGINT)
    # the first venting calls the driver four times more, and the loop that was killed never
    wait_until(lambda: program.rig.calls > calls + 4, "the second venting")
    os.kill(program.process.pid, signal.SIGINT)


def stop_the_guardian(program, and_then=lambda loop: None):
    loop = program.loop()
    os.kill(program.process.pid, signal.SIGSTOP)
    wait_until_vented(program)
    and_then(loop)
    os.kill(program.process.pid, signal.SIGCONT)


def stop_the_guardian_then_kill_the_loop(program):
    stop_the_guardian(program, lambda loop: os.kill(loop, signal.SIGKILL))


def stop_both(program):
    both = [program.loop(), program.process.pid]
    for process in both:
        os.kill(process, signal.SIGSTOP)
    time.sleep(1.0)
    for process in both:
        os.kill(process, signal.SIGCONT)


STALLED = {"loop": {"stalled_s": 0.5}}
ALONE = "the guardian process has ended"
#: Whether the loop closed the journal itself or was killed.
CLOSED, KILLED = True, False
#: What happens, settings, the message, and how the journal ends.
FAULTS = {
    "SIGTERM": (send("SIGTERM"), {}, "by Ctrl-C or a signal", CLOSED),
    "Ctrl-C": (send("SIGINT", group=True), {}, "by Ctrl-C or a signal", CLOSED),
    "terminal closed": (send("SIGHUP", group=True), {}, "by Ctrl-C or a signal", CLOSED),
    "SIGKILL to the loop": (send("SIGKILL", loop=True), {}, "code -9", KILLED),
    "SIGSTOP to the loop": (send("SIGSTOP", loop=True), STALLED, VENTED_AS_SHOWN, KILLED),
    "reading hangs": (a_reading_hangs, STALLED, "THE CHAMBERS MAY BE", KILLED),
    "SIGKILL to the guardian's group": (send("SIGKILL", group=True), {}, ALONE, CLOSED),
    "SIGSTOP to the guardian": (stop_the_guardian, STALLED, "silent", CLOSED),
    "and SIGKILL to the loop once it vented": (stop_the_guardian_then_kill_the_loop, STALLED,
                                               VENTED_AS_SHOWN, KILLED),
    "computer suspended": (stop_both, STALLED | {"limits": {"overruns_in_a_row": 20}}, "", None),
}  # fmt: skip


@pytest.mark.parametrize(("happen", "settings", "says", "closed"), FAULTS.values(), ids=FAULTS)
def test_run_in_which_something_fails_ends_vented(start, rig, happen, settings, says, closed):
    program = start("run", "sweep", **settings)
    program.is_in_mid_run()
    happen(program)
    code, output = program.end()
    assert code == (-signal.SIGKILL if says == ALONE else 1)
    assert says in output
    findings = program.journal()
    assert (findings.lost, bool(findings.reason)) == (0, True)
    # a reading that hangs comes before the writes that complete a sample
    program.ended_vented(findings.samples, lost=not closed and happen is not a_reading_hangs)
    assert closed in (None, findings.closed)
    assert not closed or (says in findings.reason and rig.opened == 0)


def test_run_whose_journal_is_replaced_stops_and_its_samples_are_saved(start, rig):
    program = start("run", "sweep", seconds=100.0)
    program.is_in_mid_run()
    (path,) = program.raw.parent.glob("*.journal")
    path.unlink()
    path.write_bytes(bytes(10**6))
    code, output = program.end()
    assert code == 1
    (saved,) = program.raw.parent.glob("*.rescued.h5")
    assert str(saved) in output
    log = read_raw(saved, experiment="sweep", sample_rate_hz=200.0, rate_tolerance=0.9)
    assert not log.attributes["complete"]
    program.ended_vented(len(log.channels["time_s"]))


@pytest.mark.parametrize("opens", [True, False])
def test_board_that_takes_long_to_open_is_waited_for_but_not_without_end(start, rig, opens):
    rig.outputs[:2] = [9.0, 9.0]
    rig.init_us = 800_000 if opens else HOUR_US
    limit_s = 10.0 if opens else 1.0
    program = start("run", "sweep", seconds=1.0, loop={"stalled_s": 0.5, "opening_s": limit_s})
    if not opens:
        wait_until(lambda: rig.calls or program.process.poll() is not None, "a call of the driver")
        rig.init_us = 0  # for the guardian
    code, output = program.end()
    assert code == (0 if opens else 1), output
    assert ("and was killed" in output and VENTED_AS_SHOWN in output) is not opens
    assert list(rig.outputs[:2]) == [0.0, 0.0]
    assert bool(program.journal().samples) is opens


def test_ticks_that_are_missed_are_counted_and_leave_a_gap(start, rig):
    program = start("run", "sweep", seconds=2.0)
    program.is_in_mid_run()
    rig.stall_us = 150_000
    calls = rig.calls
    wait_until(lambda: rig.calls > calls + 3, "a slow reading")
    rig.stall_us = 0
    code, output = program.end()
    assert code == 0, output
    findings = program.journal()
    overruns = findings.attributes["statistics"]["overruns"]
    assert (findings.reason, findings.samples + overruns) == ("", 400)
    assert overruns >= 20
    assert np.diff(findings.channels["time_s"]).max() > 0.1


def test_rig_that_is_in_use_is_left_alone(start, rig):
    program = start("run", "sweep", seconds=1000.0)
    program.is_in_mid_run()
    code, output = start("check").end()
    assert code == 1
    assert f"board {BOARDS['input_device']} is in use" in output
    os.kill(program.process.pid, signal.SIGTERM)
    program.end()
    # neither opened nor vented meanwhile: each write was one of a tick
    program.ended_vented(program.journal().samples)


def test_loop_without_a_guardian_keeps_the_boards_until_it_has_vented(start, rig):
    program = start("run", "sweep", valves={"vent_s": 0.5})
    program.is_in_mid_run()
    rig.fail(1 << 40)
    os.kill(program.process.pid, signal.SIGKILL)
    # more than while the rig is closed
    wait_until(lambda: rig.failures > 100, "attempts to vent")
    code, output = start("check").end()
    assert (code, "in use" in output) == (1, True)
    rig.fail_count = 0
    program.end()
    assert list(rig.outputs[:2]) == [0.0, 0.0]
    assert VENTED_AS_SHOWN in program.journal().reason


def test_loop_without_a_guardian_does_not_wait_for_a_driver_that_hangs(start, rig):
    program = start("run", "sweep", valves={"vent_s": 0.5})
    program.is_in_mid_run()
    rig.fail(1 << 40)  # so that the rig cannot be closed
    os.kill(program.process.pid, signal.SIGKILL)
    wait_until(lambda: rig.failures > 100, "attempts to vent")
    rig.stall_us, rig.fail_count = HOUR_US, 0
    program.end()
    assert "the valves took the voltage to vent" in program.journal().reason
    (rescued,) = program.raw.parent.glob("*.rescued.h5")
    log = read_raw(rescued, experiment="sweep", sample_rate_hz=200.0, rate_tolerance=0.9)
    program.ended_vented(len(log.channels["time_s"]), lost=1)


def test_heartbeat_for_a_watchdog_relay_stands_still_once_both_processes_are_killed(start, rig):
    program = start("run", "sweep", boards={"heartbeat_output": 5})
    program.is_in_mid_run()
    both = [program.loop(), program.process.pid]
    for number in (signal.SIGSTOP, signal.SIGKILL):
        for process in both:
            os.kill(process, number)
    program.end()
    calls, beats = rig.calls, [volts for _, channel, volts in rig.logged() if channel == 5]
    time.sleep(0.3)
    assert rig.calls == calls
    assert beats == [5.0, 0.0] * (len(beats) // 2) + [5.0] * (len(beats) % 2)
    assert len(beats) > 10


def test_third_ctrl_c_ends_a_loop_that_hangs_and_the_guardian_vents(start, rig):
    program = start("run", "sweep")
    program.is_in_mid_run()
    loop = program.loop()
    rig.stall_us = HOUR_US
    calls = rig.calls
    wait_until(lambda: rig.calls > calls, "a reading that hangs")
    for k in range(3):
        assert Path(f"/proc/{loop}").exists()
        if k == 2:
            rig.stall_us = 0  # for the guardian
        os.kill(program.process.pid, signal.SIGINT)
        time.sleep(0.2)
    code, output = program.end()
    assert code == 1
    assert "ended with code -9" in output
    assert VENTED_AS_SHOWN in output
    program.ended_vented(program.journal().samples, lost=1)
