"""Files and outputs that are none: what a person types by mistake, for every command."""

import os
import re
import struct

import h5py
import pytest
import yaml

from fprc.channels import unit_of
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
    "simulate sweep --rig X.yaml --out out.h5",
    "calibrate --published X.yaml --out out.yaml",
    "rig run sweep --config X.yaml",
    "rig run track_sweep_fprc --model X.h5",
    "rig check --config X.yaml",
    "train X.h5 --out out.h5",
    "predict X.h5 X.h5 --out out.csv",
    "export X.h5 --c out.h",
    "import X.csv --list",
    "import X.h5 --list",
    "import X.mat --list",
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
    "calibrate --published none.yaml --out X.yaml",
    "readout none.csv --map two.yaml --out X",
)


#: Names of a folder that the report can be written to.
INNOCENT = ("x" * 250, "folder", "foreign", "other")


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


def make(kind, name):
    if kind == "a pipe":
        os.mkfifo(name)
    elif kind == "a folder":
        os.mkdir(name)
    elif kind != "nothing":
        os.symlink({"a link to /dev/zero": "/dev/zero", "a link to itself": name}[kind], name)


@pytest.mark.slow
@pytest.mark.parametrize(
    "kind", ["nothing", "a pipe", "a link to /dev/zero", "a link to itself", "a folder"]
)
@pytest.mark.parametrize("command", READING)
def test_what_is_no_file_is_refused_at_once(refusal, command, kind):
    for suffix in ("yaml", "csv", "mat", "h5", "journal"):
        make(kind, f"what.{suffix}")
    assert re.search(r"what\.\w+: cannot be opened", refusal(command.replace("X", "what")))


@pytest.mark.parametrize(
    "name",
    ["x" * 300, "x" * 250, "map.yaml/out", "/proc/none/out", "folder", "foreign", "other",
     "map.yaml"],
)  # fmt: skip
@pytest.mark.parametrize("command", WRITING)
def test_output_that_cannot_be_written_is_refused_before_any_file_is_read(
    tmp_path, refusal, command, name
):
    of_folder = command.endswith("--out X")
    if name == "map.yaml" and not of_folder or of_folder and name in INNOCENT:
        return  # a file with an ending of its own; folders that can be made
    words = command.replace("X", name)
    if name == "other":
        words = words.rpartition(".")[0] + ".hdf5"
    for suffix in (".h5", ".h", ".yaml"):
        (tmp_path / f"folder{suffix}").mkdir()
        (tmp_path / f"foreign{suffix}").write_bytes(b"mine \xff")
    output = refusal(words)
    assert words.split()[-1][:40] in output
    assert "none." not in output
    assert {path.read_bytes() for path in tmp_path.glob("foreign.*")} == {b"mine \xff"}


# --- bytes that hang or crash the HDF5 library ------------------------------------------------


def plain_log(path, channels):
    """Write a log without checksums, as other programs do."""
    with h5py.File(path, "w") as log:
        log.attrs.update(experiment="sweep", source="rig", simulated=False, sample_rate_hz=200.0,
                         seed=1, software="mine", rig="{}")  # fmt: skip
        for name, values in channels.items():
            log[name] = values
            log[name].attrs["units"] = unit_of(name)


def endless(data):
    """Give a text in the heap a length that makes the library loop endlessly."""
    at = data.index(b"GCOL") + 16
    last = at
    while struct.unpack_from("<H", data, at)[0]:
        last, (size,) = at, struct.unpack_from("<Q", data, at + 8)
        at += 16 + -(-size // 8) * 8
    data[last + 8] ^= 0x72


def crashing(data):
    """Declare a text a list, so that the library reads an invalid address."""
    at = data.index(b"\x19\x01\x01\x00", data.index(b"experiment\x00"))
    data[at + 1] ^= 0x7D


@pytest.mark.slow
@pytest.mark.parametrize("spoil", [endless, crashing])
def test_byte_that_hangs_or_crashes_the_library_is_a_message(tmp_path, refusal, channels, spoil):
    plain_log(tmp_path / "log.h5", channels)
    data = bytearray((tmp_path / "log.h5").read_bytes())
    spoil(data)
    (tmp_path / "log.h5").write_bytes(data)
    assert re.search(r"log\.h5: (not read within|cannot be read)", refusal("log check log.h5"))
