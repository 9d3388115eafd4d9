import fcntl
import os
import re
import resource
import subprocess
import sys
from functools import partial
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


def problem(path):
    with pytest.raises(LogError) as caught:
        read_columns(path, NAMES)
    return str(caught.value)


def content(path, names=NAMES):
    log = read_columns(path, names)
    return log.attributes, {name: values.tobytes() for name, values in log.channels.items()}


def share_read(path, damage, cases, names=NAMES):
    """Damage copies; return the share that is read, and then as it was written; no other error."""
    whole, written, read = path.read_bytes(), content(path, names), 0
    copy = path.with_name("damaged.h5")
    for case in cases:
        copy.write_bytes(damage(whole, case))
        refusal = ""
        try:
            assert content(copy, names) == written
        except LogError as error:
            refusal = str(error)
        read += not refusal
        assert not refusal or refusal.startswith(str(copy))
    return read / len(cases)


def flip(data, at, mask=0xFF):
    return data[:at] + bytes([data[at] ^ mask]) + data[at + 1 :]


def test_log_that_another_program_has_open_is_not_called_damaged(path):
    with path.open("rb") as other:
        fcntl.flock(other, fcntl.LOCK_EX)  # as HDF5 does
        assert "is open for writing in another program" in problem(path)
    assert read_columns(path, NAMES).attributes["source"] == "sim"


@pytest.mark.parametrize(("swmr", "latest"), [(True, True), (False, True), (False, False)])
def test_log_whose_writer_was_killed_is_read_or_named(path, swmr, latest):
    copy = path.with_name("copy.h5")
    if (child := os.fork()) == 0:
        try:
            file = h5py.File(path)
            writer = h5py.File(copy, "w", libver="latest" if latest else "v108")
            for name in file:
                file.copy(name, writer)
            writer.attrs.update(file.attrs)
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
        assert content(copy) == content(path)


@given(st.lists(st.floats(-LARGEST, LARGEST), min_size=1, max_size=50))
def test_any_numbers_come_back_bit_for_bit(tmp_path_factory, values):
    path = tmp_path_factory.getbasetemp() / "any.h5"
    write_columns(path, {"p_o_kpa": np.array(values)}, {})
    assert read_columns(path, ("p_o_kpa",)).channels["p_o_kpa"].tolist() == values


def test_channels_asked_for_and_optional_ones_are_read(path):
    log = read_columns(path, ("time_s",), optional=("p_o_kpa", "p_i_kpa"))
    assert (log.path, log.names) == (path, frozenset(NAMES))
    assert list(log.channels) == ["time_s", "p_o_kpa"]
    assert {values.dtype for values in log.channels.values()} == {np.dtype(np.float64)}


def test_same_content_gives_the_same_bytes(path):
    data = path.read_bytes()
    write_columns(path, three_channels(), {"source": "sim"})
    assert path.read_bytes() == data
    # the library can stamp the file and each channel with the time of creation
    flags = [data[found.start() + 5] for found in re.finditer(b"OHDR", data)]
    assert len(flags) == 1 + len(NAMES)
    assert not any(flag & 0x20 for flag in flags)


def test_failed_write_leaves_the_old_log_and_no_litter(path):
    before = path.read_bytes()
    with pytest.raises(LogError):
        write_columns(path, {"time_s": [0.0], "theta": [1.0]}, {})
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
    assert share_read(other, lambda data, cut: data[:cut], cuts) == 0.0


@pytest.mark.slow
def test_flipped_bit_is_refused_or_carries_nothing(write_run, tmp_path, damaged_bytes):
    """A closed-loop log of 10 samples: its names and attributes do not fit into one header."""
    log = read_columns(write_run("whole.h5"), needed_by("sim", tracking=True))
    path, names = tmp_path / "log.h5", tuple(log.channels)
    write_columns(path, {name: log.channels[name][:10] for name in names}, log.attributes)
    places = damaged_bytes(path.stat().st_size)
    read = share_read(path, lambda data, at: flip(data, at, 1 << at % 8), places, names)
    # unused space between the channels and in the blocks of attributes
    assert 0.0 < read < 0.25


def test_channel_with_a_flipped_bit_is_named(path):
    with h5py.File(path) as file:
        at = file["theta_deg"].id.get_chunk_info(0).byte_offset + 8 * 150 + 2
    path.write_bytes(flip(path.read_bytes(), at, 4))
    (message,) = problem(path).splitlines()
    assert message.startswith(f"{path}: channel theta_deg: cannot be read")


def test_channel_as_other_programs_write_it_is_read(path):
    """Single precision, big-endian, in pieces, compressed and without a checksum."""
    values = np.arange(300, dtype=">f4")
    with h5py.File(path, "r+") as file:
        put("p_o_kpa", data=values, chunks=(7,), compression="gzip")(file)
    assert read_columns(path, NAMES).channels["p_o_kpa"].tolist() == values.tolist()


def put(name, *shape, **more):
    """Return what replaces a channel."""

    def change(file):
        del file[name]
        file.create_dataset(name, *shape, **more).attrs["units"] = unit_of(name)
        return file[name]

    return change


def sample(value):
    return lambda file: file["theta_deg"].__setitem__(slice(17, 20), value)


def units(value):
    return lambda file: file["p_o_kpa"].attrs.__setitem__("units", value)


def group(file):
    del file["theta_deg"]
    file.create_group("theta_deg")


def virtual(file):
    layout = h5py.VirtualLayout((300,), np.float64)
    layout[:] = h5py.VirtualSource("other.h5", "secret", (300,))
    del file["p_o_kpa"]
    file.create_virtual_dataset("p_o_kpa", layout)


def in_part(file):
    put("p_o_kpa", (295,), "f8", chunks=(10,))(file).write_direct(np.ones(290), None, np.s_[:290])


OTHER = [("other.bin", 0, h5py.h5f.UNLIMITED)]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        *((sample(x), f"theta_deg: sample 17 is {x:g}") for x in (np.nan, -np.inf, 2e10, -1e300)),
        (units("bar"), "p_o_kpa: units are bar"),
        (units(["kPa", "gauge"]), "p_o_kpa: units are none"),
        (lambda file: file["p_o_kpa"].attrs.clear(), "p_o_kpa: units are none"),
        (put("theta_deg", data=np.zeros(299)), "theta_deg: 299 samples"),
        (put("theta_deg", data=np.zeros(600)), "p_o_kpa: 300 samples"),
        *((put("theta_deg", data=wrong), "theta_deg: is ")
          for wrong in (np.zeros((300, 2)), 1.0, [b"a"] * 300, np.zeros(300, complex),
                        np.zeros(300, bool), np.zeros(300, [("a", "f8")]))),
        (lambda file: file.move("theta_deg", "g/g/theta_deg"), "theta_deg: missing"),
        (group, "theta_deg: missing"),
        # samples that are elsewhere, or made up: a small file can declare any number of them
        (put("p_o_kpa", (300,), "f8", external=OTHER), "p_o_kpa: declares 300 numbers"),
        (virtual, "p_o_kpa: declares 300 numbers"),
        (put("p_o_kpa", (10**14,), "f8", chunks=(10**6,), compression="gzip"),
         "p_o_kpa: declares 100,000,000,000,000"),
        (put("p_o_kpa", (300,), "f8"), "p_o_kpa: declares 300 numbers"),
        (in_part, "p_o_kpa: declares 295 numbers"),
    ],
)  # fmt: skip
def test_wrong_channel_is_named_with_what_is_wrong(path, monkeypatch, change, message):
    monkeypatch.chdir(path.parent)
    with h5py.File("other.h5", "w") as other:
        other["secret"] = np.zeros(300)
    Path("other.bin").write_bytes(bytes(2400))
    with h5py.File(path, "r+") as file:
        change(file)
    (line,) = problem(path).splitlines()
    assert line.startswith(f"{path}: channel {message}")


@pytest.mark.slow
def test_log_is_read_where_the_memory_of_a_process_is_limited(path):
    code = f"from fprc.logs import read_columns; read_columns({str(path)!r}, {NAMES!r})"
    limit = partial(resource.setrlimit, resource.RLIMIT_AS, (2 * 2**30,) * 2)
    subprocess.run([sys.executable, "-c", code], preexec_fn=limit, check=True)


def test_log_without_samples_is_refused(tmp_path):
    write_columns(tmp_path / "log.h5", three_channels(samples=0), {})
    assert "0 samples" in problem(tmp_path / "log.h5")


@pytest.mark.slow
def test_code_of_the_documentation_writes_checksums(tmp_path, monkeypatch):
    page = (Path(__file__).parents[3] / "data/raw/README.md").read_text(encoding="utf-8")
    (code,) = re.findall("```python\n(.*?)```", page, flags=re.DOTALL)
    given = {name: unit_of(name) for name in NAMES}
    monkeypatch.chdir(tmp_path)
    exec(code, {"h5py": h5py, "np": np, "channels": three_channels(), "units": given})
    assert read_columns("sweep.h5", NAMES).attributes == {"source": "rig"}
    with h5py.File("sweep.h5") as file:
        assert all(file[name].fletcher32 for name in NAMES)
    share_read(Path("sweep.h5"), flip, range(0, Path("sweep.h5").stat().st_size, 41))
