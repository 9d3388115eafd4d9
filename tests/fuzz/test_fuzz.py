"""The fuzzing program: some of its cases, and whether it detects wrong behaviour."""

import importlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
import yaml

FUZZ = Path(__file__).parent
LINUX = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="looks into /proc")


def module(name):
    return importlib.import_module(name)


@LINUX
@pytest.mark.slow
def test_damaged_files_have_allowed_outcomes(tmp_path):
    command = [sys.executable, FUZZ, "--cases", "100", "--workers", "1", "--keep", tmp_path]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "seed 1, 100 cases" in done.stdout


@LINUX
@pytest.mark.slow
def test_changed_model_files_are_refused_or_whole(tmp_path):
    """100 files, or FPRC_MODEL_FILES=2000."""
    cases = os.environ.get("FPRC_MODEL_FILES", "100")
    kind = ["--kind", "model_files", "--cases", cases, "--workers", "1", "--keep", tmp_path]
    done = subprocess.run([sys.executable, FUZZ, *kind], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"seed 1, {cases} cases" in done.stdout


# --- limits on time and memory --------------------------------------------------------------


def grow():
    kept = np.ones(5 << 25)
    return int(kept[0]) - 1


@LINUX
@pytest.mark.parametrize(
    ("call", "outcome"),
    [
        (lambda: sum(iter(int, 1)), "hang"),
        (lambda: time.sleep(60.0), "hang"),
        (grow, "over 1 GB"),
        (lambda: os.kill(os.getpid(), signal.SIGKILL), "traceback"),
        (lambda: print("done"), "same"),
    ],
    ids=["loops", "sleeps", "grows", "crashes", "ends"],
)
def test_command_that_hangs_grows_or_crashes_is_stopped(tmp_path, call, outcome):
    judging, running = module("judging"), module("running")
    step = judging.Step(
        (), "fprc x", (), lambda folder, ended: ("same", ""), call=lambda command: call(),
        limit_s=20.0 if call is grow else 1.0,
    )  # fmt: skip
    found, _ = running.attempt(step, judging.Case("", "", [step]), tmp_path)
    assert found.outcome == outcome, found


# --- the reading of configurations ----------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "got", "same"),
    [
        ("a: 010", 10, True),
        ("a: 010", 8, False),
        ("a: 1:30", 90, False),
        ("a: 0o10", 8, True),
        ("a: 1e3", 1000.0, True),
        ("a: '7'", 7, True),
        ("a: [1, 2]", (1, 2), True),
        ("a: [1, 2]", (1, 2, 3), False),
        ("a: x", "x", True),
        ("a: no", False, True),
        ("a: ~", None, True),
        ("b: 3", 5, False),
    ],
)
def test_settings_are_compared_with_what_a_person_reads(text, got, same):
    reading = module("reading")
    said = reading.read(text.encode())
    assert (reading.differing({"a": got}, said, {"a": 3}) == []) is same


@pytest.mark.parametrize("text", ["a: 1\na: 2", "- 1", "5", "a: &x [*x]", "{a", "a: " + "[" * 5000])
def test_text_without_a_unique_meaning_is_unclear(text):
    reading = module("reading")
    with pytest.raises(reading.UnclearError):
        reading.read(text.encode())


# --- judging the outcome --------------------------------------------------------------------


@pytest.fixture
def ended():
    """Make the record of a command that ended; by default it succeeded."""
    judging = module("judging")

    def ended(code=0, out="", err="", peak_bytes=0):
        return judging.Ended(code, out, err, peak_bytes)

    return ended


@pytest.mark.parametrize(
    ("what", "outcome"),
    [
        ({}, "same"),
        ({"code": 1, "err": "error: log.h5: damaged"}, "refused"),
        ({"code": 1, "err": "error: damaged"}, "untidy"),
        ({"code": 1, "err": "Traceback (most recent call last):\nerror: log.h5"}, "traceback"),
        ({"code": -11}, "traceback"),
        ({"peak_bytes": 2 << 30}, "over 1 GB"),
        ({"out": "\x1b[2J"}, "untidy"),
        ({"out": '{"a": NaN}'}, "untidy"),
        ({"err": "x.py:3: RuntimeWarning: overflow"}, "untidy"),
    ],
)
def test_outcome_is_judged_by_what_a_user_sees(tmp_path, ended, what, outcome):
    judging = module("judging")
    step = judging.Step(("x",), "fprc x", ("log.h5",), lambda folder, ended: ("same", ""))
    assert judging.outcome_of(step, tmp_path, {}, ended(**what))[0] == outcome


@pytest.mark.parametrize("code", [0, 1])
def test_file_that_is_changed_or_left_behind_is_untidy(tmp_path, ended, code):
    judging = module("judging")
    step = judging.Step(("x",), "fprc x", ("log.h5",), lambda folder, ended: ("same", ""))
    (tmp_path / "log.h5").write_bytes(b"now")
    for before, said in (({"log.h5": "before"}, "changed log.h5"), ({}, "left log.h5")):
        found = judging.outcome_of(step, tmp_path, before, ended(code, err="error: log.h5: no"))
        assert found[0] == "untidy"
        assert found[1].startswith(said)


@pytest.fixture
def log(tmp_path):
    """A raw log, also written to a file."""
    found = module("raw_logs").logs()["track"]
    (tmp_path / "log.h5").write_bytes(found.data)
    return found


@pytest.mark.parametrize("what", ["nothing", "number", "attribute", "unit"])
def test_log_in_which_one_thing_is_changed_is_not_the_same(tmp_path, ended, log, what):
    with h5py.File(tmp_path / "log.h5", "a") as file:
        if what == "number":
            file["p_ff_kpa"][7] += 1e-12
        elif what == "attribute":
            file.attrs["controller"] = "pd"
        elif what == "unit":
            file["p_ff_kpa"].attrs["units"] = "bar"
    (step,) = module("raw_logs").case_of("raw log", "x", log).steps
    found = [step.judge(tmp_path, ended(code))[0] for code in (0, 1)]
    different = ["accepted silently", "different, reported"]
    assert found == (["same", "same"] if what == "nothing" else different)


@pytest.mark.parametrize("way", [None, "exchanged", "changed"])
def test_samples_of_a_journal_are_those_that_were_written(way):
    journals = module("journals")
    written = np.arange(30.0).reshape(10, 3)
    rows = np.delete(written, 4, axis=0)
    if way == "exchanged":
        rows[[2, 5]] = rows[[5, 2]]
    elif way == "changed":
        rows[2, 1] += 1e-12
    assert journals.in_order(rows, written) is (way is None)


@pytest.fixture
def mapping():
    """Map of a recording at the rate of the log."""
    return {
        "sample_rate_hz": 100.0,
        "time": {"column": "t", "unit": "ms"},
        "channels": {"p_exp_kpa": {"column": "p", "unit": "bar", "scale": 2.0, "offset": -1.0}},
    }


def test_import_is_expected_in_the_units_of_the_log_with_its_gaps(mapping):
    columns = {"t": np.array([0.0, 10.0, 20.0, 50.0, 60.0]) + 1e6, "p": np.arange(5.0)}
    expected, gaps = module("imports").expect(mapping, columns)
    assert gaps == 1
    assert expected["time_s"] == pytest.approx(np.arange(7) / 100.0)
    p_kpa = 200.0 * np.array([0, 1, 2, 7 / 3, 8 / 3, 3, 4]) - 100.0
    assert expected["p_exp_kpa"] == pytest.approx(p_kpa)


@pytest.mark.parametrize(("how", "value"), [("first", 2.0), ("mean", 2.5)])
def test_repeated_stamps_are_expected_once(mapping, how, value):
    mapping["time"]["repeated"] = how
    columns = {"t": np.array([0.0, 10.0, 20.0, 20.0, 30.0]), "p": np.arange(5.0)}
    expected, _ = module("imports").expect(mapping, columns)
    assert expected["p_exp_kpa"][2] == pytest.approx(200.0 * value - 100.0)


@pytest.mark.parametrize(
    "columns",
    [
        {"t": np.array([0.0, 10.0, 10.0]), "p": np.arange(3.0)},
        {"t": 10.0 * np.arange(3), "p": np.array([0.0, np.nan, 1.0])},
        {"t": 10.0 * np.arange(3), "p": np.array([0.0, 1e308, 1.0])},
        {"t": 10.0 * np.arange(3), "p": None},
        {"t": 10.0 * np.arange(3), "p": np.arange(4.0)},
        {"t": 10.0 * np.arange(3)},
    ],
    ids=["clock", "no number", "overflow", "text", "length", "absent"],
)
def test_recording_that_is_wrong_is_expected_to_be_refused(mapping, columns):
    imports = module("imports")
    with pytest.raises(imports.WrongError):
        imports.expect(mapping, columns)


@pytest.mark.parametrize(
    ("text", "columns"),
    [
        ('t,"a,deg",p\n0,1,2\n1,3,4\n', {"t": [0, 1], "a,deg": [1, 3], "p": [2, 4]}),
        ("# note\nt,p\n0,x\n1,2\n", {"t": [0, 1], "p": None}),
        ("t,p\n0,1\n1\n", "a row has not as many fields"),
        ("t,t\n0,1\n", "there twice"),
    ],
)
def test_text_is_read_by_another_reader(text, columns):
    csv_files, imports = module("csv_files"), module("imports")
    written = csv_files.Written(b"", ",", False, "utf-8", 0)
    if isinstance(columns, str):
        with pytest.raises(imports.WrongError, match=columns):
            csv_files.read(text.encode(), written)
        return
    found = csv_files.read(text.encode(), written)
    for name, values in columns.items():
        assert (None if found[name] is None else found[name].tolist()) == values


# --- the cases ------------------------------------------------------------------------------


def test_case_is_made_of_its_seed_and_its_number_alone(tmp_path):
    cases = module("cases")
    made = []
    for folder in (tmp_path / "one", tmp_path / "two"):
        folder.mkdir()
        cases.make_case(5, 3, folder)  # another case before
        for path in folder.iterdir():
            path.unlink()
        case = cases.make_case(5, 17, folder)
        made.append((case.what, {path.name: path.read_bytes() for path in folder.iterdir()}))
    assert made[0] == made[1]


def test_map_of_a_recording_is_yaml(tmp_path):
    imports = module("imports")
    rng = np.random.default_rng(1)
    for _ in range(50):
        mapping = imports.any_map(rng, {"theta_deg": "a"}, {"column": "t", "unit": "s"}, 200.0)
        imports.spoil(rng, mapping)
        imports.write_map(tmp_path, mapping)
        assert isinstance(yaml.safe_load((tmp_path / "map.yaml").read_text()), dict)
