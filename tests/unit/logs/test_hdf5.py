"""Small files that declare huge datasets, or link to other files."""

import h5py
import numpy as np
import pytest

from fprc.errors import LogError
from fprc.logs import read_columns, write_columns

NAMES = ("time_s", "p_o_kpa")


@pytest.fixture
def path(tmp_path):
    time_s = np.arange(300) / 200.0
    write_columns(tmp_path / "log.h5", {"time_s": time_s, "p_o_kpa": 100.0 + time_s}, {})
    return tmp_path / "log.h5"


def replace(path, make):
    """Replace p_o_kpa by another object."""
    with h5py.File(path, "r+") as file:
        del file["p_o_kpa"]
        made = make(file)
        if made is not None:
            made.attrs["units"] = "kPa"


def problem(read, *arguments):
    with pytest.raises(LogError) as caught:
        read(*arguments)
    return str(caught.value)


# --- elsewhere ------------------------------------------------------------------------------


def linked_outside(file):
    file["p_o_kpa"] = h5py.ExternalLink("other.h5", "/secret")


def linked_inside(file):
    file["p_o_kpa"] = h5py.SoftLink("/time_s")


def stored_outside(file):
    outside = [("other.bin", 0, h5py.h5f.UNLIMITED)]
    return file.create_dataset("p_o_kpa", (300,), np.float64, external=outside)


def virtual(file):
    layout = h5py.VirtualLayout((300,), np.float64)
    layout[:] = h5py.VirtualSource("other.h5", "secret", (300,))
    return file.create_virtual_dataset("p_o_kpa", layout)


@pytest.mark.parametrize("make", [linked_outside, linked_inside, stored_outside, virtual])
def test_channel_that_is_elsewhere_is_refused(path, tmp_path, make):
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["secret"] = np.zeros(300)
    (tmp_path / "other.bin").write_bytes(bytes(2400))
    replace(path, make)
    for asked in (NAMES, ()), (("time_s",), ("p_o_kpa",)):
        assert problem(read_columns, path, *asked).startswith(f"{path}: channel p_o_kpa: ")


# --- never written --------------------------------------------------------------------------------


def huge(samples, **more):
    def make(file):
        return file.create_dataset("p_o_kpa", (samples,), np.float64, **more)

    return make


def partly(samples, chunk, written):
    def make(file):
        dataset = file.create_dataset("p_o_kpa", (samples,), np.float64, chunks=(chunk,))
        dataset[written] = 1.0
        return dataset

    return make


@pytest.mark.parametrize(
    ("make", "samples", "which"),
    [
        (huge(10**9, chunks=(10**5,), compression="gzip"), 10**9, "10,000 of its 10,000 chunks"),
        (huge(10**14, chunks=(10**6,)), 10**14, "100,000,000 of its"),
        (huge(300), 300, "none was"),
        (huge(300, chunks=(10,)), 300, "30 of its 30 chunks"),
        (partly(300, 10, slice(0, 100)), 300, "20 of its 30 chunks"),
        (partly(295, 10, slice(0, 290)), 295, "1 of its 30 chunks"),
        (partly(10**9, 10**5, slice(10**5, 10**5 + 9)), 10**9, "9,999 of its 10,000 chunks"),
    ],
)
def test_samples_that_were_never_written_are_refused_before_they_are_made_up(
    path, make, samples, which
):
    replace(path, make)
    message = problem(read_columns, path, NAMES)
    assert f"{path}: channel p_o_kpa: declares {samples:,} numbers, but {which}" in message


def test_thousands_of_channels_are_named_in_part(path):
    with h5py.File(path, "r+", libver="latest") as file:
        del file["p_o_kpa"]
        file.create_group("others")
        for number in range(2000):
            file[f"x{number:05}_kpa"] = file["others"]
    message = problem(read_columns, path, NAMES)
    assert message.startswith(f"{path}: channel p_o_kpa: missing; the file has others, time_s, x0")
    assert message.endswith(", x00009_kpa and 1990 more")


def test_names_cannot_command_the_terminal(path):
    with h5py.File(path, "r+") as file:
        file["\x1b[2J"] = 1.0
        del file["p_o_kpa"]
    assert r"the file has \x1b[2J, time_s" in problem(read_columns, path, NAMES)
