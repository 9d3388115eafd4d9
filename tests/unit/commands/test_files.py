"""Files and outputs that are none: what a person types by mistake, for every command."""

import os
import re

import pytest
import yaml

from fprc.cli import main

MAP = {
    "time": {"column": "t"},
    "channels": {
        "theta_deg": {"column": "angle", "unit": "deg"},
        "p_exp_kpa": {"column": "p", "unit": "kPa"},
        "p_o_kpa": {"column": "z", "unit": "kPa"},
    },
}
#: Commands that read a file, X.
READING = (
    "config check X.yaml",
    "simulate sweep --config X.yaml --out out.h5",
    "calibrate X.yaml --out out.yaml",
    "rig run sweep --config X.yaml",
    "rig run track_sweep_fprc --model X.h5",
    "rig check --config X.yaml",
    "train X.h5 --out out.h5",
    "predict X.h5 X.h5 --out out.csv",
    "export X.h5 --c out.h",
    "import X.csv --draft",
    "import X.h5 --draft",
    "import X.mat --draft",
    "import arm.csv --map X.yaml --out out.h5",
    "readout X.csv --map two.yaml --out out",
    "log check X.h5",
    "log repair X.journal --out out.h5",
)
#: Commands that write a file, X; what they would read is not there.
WRITING = (
    "simulate sweep --config none.yaml --out X.h5",
    "train none.h5 --out X.h5",
    "predict none.h5 none.h5 --out X.h5",
    "export none.h5 --c X.h",
    "import none.csv --map map.yaml --out X.h5",
    "log repair none.h5 --out X.h5",
    "rig run sweep --out X.h5",
    "calibrate --out X.yaml",
)


@pytest.fixture
def refusal(tmp_path, monkeypatch, capfd):
    """Run a command in a folder with two maps; it fails, leaves nothing, and says why."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "map.yaml").write_text(yaml.safe_dump({"experiment": "sweep", **MAP}))
    (tmp_path / "two.yaml").write_text(yaml.safe_dump({"test_from_s": 1, **MAP}))

    def refusal(command):
        before = set(tmp_path.iterdir())
        try:
            code = main(command.split())
        except SystemExit as end:
            code = end.code
        output = "".join(capfd.readouterr())
        assert code == 1, output
        assert "Traceback" not in output
        assert set(tmp_path.iterdir()) == before
        return output

    return refusal


@pytest.mark.slow
@pytest.mark.parametrize("command", READING)
def test_what_is_no_file_is_refused_at_once(refusal, command):
    """A folder; what else is none: tests/unit/test_given.py."""
    for suffix in ("yaml", "csv", "mat", "h5", "journal"):
        os.mkdir(f"what.{suffix}")
    assert re.search(r"what\.\w+: cannot be opened", refusal(command.replace("X", "what")))


@pytest.mark.parametrize("command", WRITING)
def test_output_that_cannot_be_written_is_refused_before_any_file_is_read(
    tmp_path, refusal, command
):
    """A file of another program, and another ending; more: tests/unit/test_artifacts.py."""
    for suffix in (".h5", ".h", ".yaml"):
        (tmp_path / f"foreign{suffix}").write_bytes(b"mine \xff")
    for words in (command.replace("X", "foreign"), command.rpartition("X")[0] + "other.hdf5"):
        output = refusal(words)
        assert re.search(rf"{words.split()[-1]}'?: .*(exists and|must end in|cannot be)", output)
        assert "none." not in output
    assert {path.read_bytes() for path in tmp_path.glob("foreign*")} == {b"mine \xff"}


def test_run_that_lacks_a_trained_model_asks_for_the_option_that_names_one(refusal):
    assert "--model" in refusal("rig run track_sweep_fprc")
