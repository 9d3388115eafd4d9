import fcntl
import os
import re
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.channels import needed_by, unit_of
from fprc.errors import LogError
from fprc.logs import read_columns, write_columns
from fprc.logs.columns import LARGEST

NAMES = ("time_s", "p_o_kpa", "theta_deg")


def three_channels(samples=300):
    t = np.arange(samples) / 200.0
    return {"time_s": t, "p_o_kpa": 100.0 + np.sin(t), "theta_deg": 30.0 * np.cos(t)}


@pytest.fixture
def path(tmp_path):
    write_columns(tmp_path / "log.h5", three_channels(), {"source": "sim"})
    return tmp_path / "log.h5"


def problem(path, names=NAMES):
    with pytest.raises(LogError) as caught:
        read_columns(path, names)
    return str(caught.value)


def outcomes(path, cases, names=NAMES):
    """Return the outcomes of reading damaged copies: cut, or with a flipped byte."""

    def content(path):
        log = read_columns(path, names)
        return log.attributes, {name: values.tobytes() for name, values in log.channels.items()}

    whole, written, found = path.read_bytes(), content(path), []
    copy = path.with_name("damaged.h5")
    for case in cases:
        data = bytearray(whole[: case.get("cut", len(whole))])
        if "flip" in case:
            at, mask = case["flip"]
            data[at] ^= mask
        copy.write_bytes(data)
        try:
            found.append("read" if content(copy) == written else "read, and it differs")
        except LogError as error:
            found.append("LogError" if str(error).startswith(str(copy)) else str(error))
    return found


def test_log_that_another_program_has_open_is_not_called_damaged(path):
    with path.open("rb") as other:
        fcntl.flock(other, fcntl.LOCK_EX)  # as HDF5 does
        found = problem(path)
    assert "is open for writing in another program" in found
    assert read_columns(path, NAMES).attributes["source"] == "sim"


@pytest.mark.parametrize(("swmr", "latest"), [(True, True), (False, True), (False, False)])
def test_log_whose_writer_was_killed_is_read_or_named(path, swmr, latest):
    whole = read_columns(path, NAMES)
    copy = path.with_name("copy.h5")
    if (child := os.fork()) == 0:
        try:
            file = h5py.File(path)
            writer = h5py.File(copy, "w", libver="latest" if latest else "v108")
            for name in file:
                file.copy(name, writer)
            for name, value in file.attrs.items():
                writer.attrs[name] = value
            if swmr:
                writer.swmr_mode = True
            writer.flush()
        finally:
            os._exit(9)
    os.waitpid(child, 0)
    if latest and not swmr:
        found = problem(copy)
        assert "ended without closing it" in found
        assert "delete" not in found
    else:
        read = read_columns(copy, NAMES)
        assert all(np.array_equal(read.channels[name], whole.channels[name]) for name in NAMES)


def test_channels_and_attributes_come_back_as_they_were(path):
    log = read_columns(path, NAMES)
    assert (log.path, list(log.channels), log.attributes) == (path, list(NAMES), {"source": "sim"})
    for name, values in three_channels().items():
        assert log.channels[name].dtype == np.float64
        assert log.channels[name].tobytes() == values.tobytes()


@given(st.lists(st.floats(-LARGEST, LARGEST), min_size=1, max_size=50))
def test_any_numbers_come_back_bit_for_bit(tmp_path_factory, values):
    path = tmp_path_factory.getbasetemp() / "any.h5"
    write_columns(path, {"p_o_kpa": np.array(values)}, {})
    assert read_columns(path, ("p_o_kpa",)).channels["p_o_kpa"].tolist() == values


def test_channels_asked_for_and_optional_ones_are_read(path):
    log = read_columns(path, ("time_s",), optional=("p_o_kpa", "p_i_kpa"))
    assert list(log.channels) == ["time_s", "p_o_kpa"]
    with h5py.File(path, "r+") as file:
        file["p_o_kpa"][5] = np.nan
    with pytest.raises(LogError, match="channel p_o_kpa: sample 5"):
        read_columns(path, ("time_s",), optional=("p_o_kpa",))


def test_same_content_gives_the_same_bytes(path):
    data = path.read_bytes()
    write_columns(path, three_channels(), {"source": "sim"})
    assert path.read_bytes() == data
    # the library can stamp the file and each channel with the time of creation
    flags = [data[found.start() + 5] for found in re.finditer(b"OHDR", data)]
    assert len(flags) == 1 + len(NAMES)
    assert not any(flag & 0x20 for flag in flags)


@pytest.mark.parametrize(
    ("channels", "attributes", "error"),
    [
        ({"time_s": [0.0], "theta": [1.0]}, {}, LogError),
        ({"time_s": ["now"]}, {}, ValueError),
        ({"time_s": [0.0]}, {"rig": object()}, TypeError),
    ],
)
def test_failed_write_leaves_the_old_log_and_no_litter(path, channels, attributes, error):
    before = path.read_bytes()
    with pytest.raises(error):
        write_columns(path, channels, attributes)
    assert path.read_bytes() == before
    assert [entry.name for entry in path.parent.iterdir()] == ["log.h5"]


@pytest.mark.parametrize("version", ["earliest", "v108", "v110", "latest"])
def test_log_of_any_hdf5_format_is_read_whole_and_refused_when_cut(path, version):
    other = path.with_name("other.h5")
    with h5py.File(path) as source, h5py.File(other, "w", libver=(version, "latest")) as file:
        for name in NAMES:
            source.copy(name, file)
    size = other.stat().st_size
    cuts = [*range(0, 120, 7), *range(120, size, 250), size - 1]
    assert set(outcomes(other, [{"cut": cut} for cut in cuts])) == {"LogError"}
    assert outcomes(other, [{"cut": size}]) == ["read"]


@pytest.mark.slow
def test_flipped_bit_is_refused_or_carries_nothing(write_run, tmp_path, damaged_bytes):
    """A closed-loop log of 10 samples: its names and attributes do not fit into one header."""
    log = read_columns(write_run("whole.h5"), needed_by("sim", tracking=True))
    path, names = tmp_path / "log.h5", tuple(log.channels)
    write_columns(path, {name: log.channels[name][:10] for name in names}, log.attributes)
    flips = damaged_bytes(path.stat().st_size)
    found = outcomes(path, [{"flip": (at, 1 << at % 8)} for at in flips], names)
    assert set(found) == {"LogError", "read"}
    # unused space between the channels and in the blocks of attributes
    assert found.count("read") < 0.25 * len(found)


def test_channel_with_a_flipped_bit_is_named(path):
    with h5py.File(path) as file:
        at = file["theta_deg"].id.get_chunk_info(0).byte_offset + 8 * 150 + 2
    data = bytearray(path.read_bytes())
    data[at] ^= 4
    path.write_bytes(data)
    (message,) = problem(path).splitlines()
    assert message.startswith(f"{path}: channel theta_deg: cannot be read")


def test_channels_without_a_checksum_are_listed(path):
    """Single precision, big-endian, in pieces and compressed, as other programs write it."""
    values = np.arange(300, dtype=">f4")
    with h5py.File(path, "r+") as file:
        for name, checked in {"p_o_kpa": True, "theta_deg": False}.items():
            units = file[name].attrs["units"]
            del file[name]
            file.create_dataset(
                name, data=values, chunks=(7,), compression="gzip", fletcher32=checked
            ).attrs["units"] = units
    log = read_columns(path, NAMES)
    assert log.channels["p_o_kpa"].tolist() == values.tolist()
    assert log.unchecked == ("theta_deg",)


def replace(name, values):
    def change(file):
        del file[name]
        file[name] = values
        file[name].attrs["units"] = unit_of(name)

    return change


def sample(value):
    return lambda file: file["theta_deg"].__setitem__(slice(17, 20), value)


def units(value):
    return lambda file: file["p_o_kpa"].attrs.__setitem__("units", value)


def group(file):
    del file["theta_deg"]
    file.create_group("theta_deg")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        *((sample(x), f"theta_deg: sample 17 is {x:g}") for x in (np.nan, -np.inf, 2e10, -1e300)),
        (units("bar"), "p_o_kpa: units are bar"),
        (units(["kPa", "gauge"]), "p_o_kpa: attribute units"),
        (lambda file: file["p_o_kpa"].attrs.clear(), "p_o_kpa: units are none"),
        (replace("theta_deg", np.zeros(299)), "theta_deg: 299 samples"),
        (replace("theta_deg", np.zeros(600)), "time_s: 300 samples"),
        *((replace("theta_deg", wrong), "theta_deg: is ")
          for wrong in (np.zeros((300, 2)), 1.0, [b"a"] * 300, np.zeros(300, complex),
                        np.zeros(300, bool), np.zeros(300, [("a", "f8")]))),
        (lambda file: file.move("theta_deg", "theta_deg "), "theta_deg: missing"),
        (lambda file: file.move("theta_deg", "g/g/theta_deg"), "theta_deg: missing"),
        (group, "theta_deg: missing"),
    ],
)  # fmt: skip
def test_wrong_channel_is_named_with_what_is_wrong(path, change, message):
    with h5py.File(path, "r+") as file:
        change(file)
    (line,) = problem(path).splitlines()
    assert line.startswith(f"{path}: channel {message}")


def test_log_without_samples_is_refused(tmp_path):
    write_columns(tmp_path / "log.h5", three_channels(samples=0), {})
    assert problem(tmp_path / "log.h5").startswith(f"{tmp_path / 'log.h5'}: no samples")


@pytest.mark.slow
def test_code_of_the_documentation_writes_checksums(tmp_path, monkeypatch):
    page = (Path(__file__).parents[3] / "data/raw/README.md").read_text(encoding="utf-8")
    (code,) = re.findall("```python\n(.*?)```", page, flags=re.DOTALL)
    units = {name: unit_of(name) for name in NAMES}
    monkeypatch.chdir(tmp_path)
    exec(code, {"h5py": h5py, "np": np, "channels": three_channels(), "units": units})
    log = read_columns("sweep.h5", NAMES)
    assert (log.attributes, log.unchecked) == ({"source": "rig"}, ())
    size = (tmp_path / "sweep.h5").stat().st_size
    cases = [{"flip": (at, 0xFF)} for at in range(0, size, 41)]
    assert set(outcomes(tmp_path / "sweep.h5", cases)) <= {"LogError", "read"}


def create(samples, **more):
    return lambda file: file.create_dataset("p_o_kpa", (samples,), "f8", **more)


def virtual(file):
    layout = h5py.VirtualLayout((300,), np.float64)
    layout[:] = h5py.VirtualSource("other.h5", "secret", (300,))
    file.create_virtual_dataset("p_o_kpa", layout)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (create(300, external=[("other.bin", 0, h5py.h5f.UNLIMITED)]), "its samples are in"),
        (virtual, "its samples are in"),
        (create(10**14, chunks=(10**6,), compression="gzip"), "declares 100,000,000,000,000"),
        (create(300), "declares 300 numbers"),
        (lambda file: create(295, chunks=(10,))(file).write_direct(np.ones(290), None, np.s_[:290]),
         "declares 295 numbers"),
    ],
)  # fmt: skip
def test_channel_that_is_elsewhere_or_was_never_written_is_refused(path, tmp_path, make, message):
    """Before its samples are read, or made up: a small file can declare any number of them."""
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["secret"] = np.zeros(300)
    (tmp_path / "other.bin").write_bytes(bytes(2400))
    with h5py.File(path, "r+") as file:
        del file["p_o_kpa"]
        make(file)
    for asked in (NAMES, ()), (("time_s",), ("p_o_kpa",)):
        with pytest.raises(LogError) as caught:
            read_columns(path, *asked)
        assert str(caught.value).startswith(f"{path}: channel p_o_kpa: {message}")
