import calendar

import h5py
import numpy as np
import pandas as pd
import pytest
import scipy.sparse
from matio import save_to_mat

from fprc.errors import LogError
from fprc.recordings.arrays import read_arrays
from fprc.recordings.source import pick

Y = np.arange(50.0).reshape(-1, 1)


@pytest.fixture
def written(tmp_path):
    """Let a function write an HDF5 file, and return the source read from it."""

    def written(write):
        with h5py.File(tmp_path / "log.h5", "w") as file:
            write(file)
        return read_arrays(tmp_path / "log.h5", matlab=False)

    return written


@pytest.fixture(params=["5", "7.3"])
def read(request, tmp_path, matlab_files):
    """Write variables as a version of MATLAB does, and return the source read."""
    writers = {"5": matlab_files.write_matlab5, "7.3": matlab_files.write_matlab73}

    def read(content):
        writers[request.param](tmp_path / "log.mat", content)
        source = read_arrays(tmp_path / "log.mat", matlab=True)
        assert source.kind == f"MATLAB {request.param}"
        return source

    return read


def columns(source):
    return {name: values.tolist() for name, values in source.columns.items()}


# --- MATLAB ---------------------------------------------------------------------------------


def test_parts_have_the_names_that_matlab_gives_them(read, matlab_files):
    """Every name listed can be used in a map."""
    Cells = matlab_files.Cells  # noqa: N806
    steps = [{"y": k * Y, "u": {"p": -k * Y}} for k in (1, 2, 3)]
    source = read(
        {
            "x": Y,
            "train": Cells((1, 3), steps),
            "grid": Cells((2, 2), [1 * Y, 2 * Y, 3 * Y, 4 * Y]),
            "deep": {"a": {"b": Cells((2, 1), [Y, {"c": steps[0]}])}},
            "one": Cells((1, 1), [Y]),
            "q": np.arange(6.0).reshape(3, 2),
        }
    )
    y = Y.ravel()
    expected = {"x": y, "one{1}": y, "deep.a.b{1}": y}
    for k in (1, 2, 3):
        expected |= {f"train{{{k}}}.y": k * y, f"train{{{k}}}.u.p": -k * y}
    expected |= {"deep.a.b{2}.c.y": y, "deep.a.b{2}.c.u.p": -y}
    expected |= {f"grid{{{k}}}": k * y for k in (1, 2, 3, 4)}
    expected |= {"q[:, 0]": np.array([0.0, 2.0, 4.0]), "q[:, 1]": np.array([1.0, 3.0, 5.0])}
    assert columns(source) == {name: values.tolist() for name, values in expected.items()}
    assert all(pick(source, name).tolist() == values.tolist() for name, values in expected.items())
    assert source.others == {}


def test_struct_array_is_named_and_leaves_the_rest_of_the_file(read, matlab_files):
    rows = [{"Time": 0.1 * k, "p": Y} for k in range(5)]
    source = read({"x": Y, "run": matlab_files.Structs((5, 1), rows)})
    assert (list(source.columns), list(source.others)) == (["x"], ["run"])


def test_empty_and_non_numeric_parts_leave_the_rest_of_the_file(read, matlab_files):
    nothing = np.zeros((0, 0))
    source = read(
        {
            "x": Y,
            "none": nothing,
            "cell": matlab_files.Cells((0, 0), []),
            "cells": matlab_files.Cells((1, 2), [nothing, Y]),
            "s": matlab_files.Structs((0, 0), []),
            "run": {"a": nothing, "b": Y},
            "name": "arm",
            "video": np.zeros((2, 3, 4)),
            "rate": np.ones((1, 1)),
        }
    )
    assert sorted(columns(source)) == ["cells{2}", "run.b", "x"]
    assert set(source.others) == {"none", "cell", "cells{1}", "s", "run.a", "name", "video", "rate"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("run.q", "did you mean run.q[:, "),
        ("run.q[:,2]", "did you mean run.q[:, 2]?"),
        ("run.q[1, :]", "did you mean run.q[:, "),
        ("run.Q[:, 1]", "did you mean run.q[:, 1]?"),
        ("run(3).y", "did you mean run.y?"),
        ("name", "cannot be a channel: text"),
    ],
)
def test_wrong_column_is_refused_with_the_right_ones(read, text, message):
    q = np.arange(30.0).reshape(10, 3)
    source = read({"run": {"q": q, "y": Y}, "name": "arm"})
    with pytest.raises(LogError) as caught:
        pick(source, text)
    assert message in str(caught.value)


def test_cell_that_holds_itself_is_refused(tmp_path, matlab_files):
    matlab_files.write_matlab73(tmp_path / "log.mat", {"c": matlab_files.Cells((1, 1), [Y])})
    with h5py.File(tmp_path / "log.mat", "r+") as file:
        file["c"][...] = file["c"].ref
    with pytest.raises(LogError):
        read_arrays(tmp_path / "log.mat", matlab=True)


@pytest.mark.parametrize("version", ["v7", "v7.3"])
def test_tables_and_times_are_columns_and_other_objects_are_not(version, tmp_path):
    p = [1.5, 2.5, 4.0]
    steps = pd.to_timedelta([0, 5, 10], "ms").as_unit("ns").rename("Time")
    dates = pd.to_datetime(["2024-03-01T12:00:00.000", "2024-03-01T12:00:00.005", None])
    content = {
        "tt": pd.DataFrame({"p": p}, index=steps),
        "run": pd.DataFrame({"p": p, "at": dates.as_unit("ns"), "note": list("abc")}),
        "s": scipy.sparse.eye_array(5).tocsc(),
        "map": {"a": np.ones((1, 1))},
        "words": np.array([["a", "b"]]),
        "x": Y,
    }
    save_to_mat(str(tmp_path / "log.mat"), content, version=version)
    source = read_arrays(tmp_path / "log.mat", matlab=True)
    noon = calendar.timegm((2024, 3, 1, 12, 0, 0))
    found = columns(source)
    assert found.pop("run.at") == pytest.approx([noon, noon + 0.005, np.nan], abs=1e-6, nan_ok=True)
    assert found == {"tt.Time": [0, 0.005, 0.01], "tt.p": p, "run.p": p, "x": Y.ravel().tolist()}
    assert {"run.note", "s", "words"} <= set(source.others)


# --- HDF5 -----------------------------------------------------------------------------------


def test_pictures_texts_and_single_numbers_are_no_channels(written):
    def write(file):
        file["video"] = np.zeros((4, 3, 3))
        file["who"] = "me"
        file["rate"] = 100.0
        file["none"] = h5py.Empty("f8")
        file["no"] = np.zeros(0)
        file["on"] = np.arange(5) > 2
        file["group/x"] = np.arange(5)
        file["row"] = np.zeros((1, 5))

    source = written(write)
    assert {name: array.shape for name, array in source.columns.items()} == dict.fromkeys(
        ("group/x", "on", "row"), (5,)
    )
    assert set(source.others) == {"video", "who", "rate", "none", "no"}


def test_links_are_named_and_not_followed(written, tmp_path):
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["y"] = np.arange(3.0)

    def write(file):
        file["x"] = np.arange(5.0)
        file["same"] = file["x"]
        file["outside"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "/y")
        file["nowhere"] = h5py.SoftLink("/gone")
        layout = h5py.VirtualLayout((3,), "f8")
        layout[:] = h5py.VirtualSource(tmp_path / "other.h5", "y", (3,))
        file.create_virtual_dataset("virtual", layout)
        file.create_dataset("raw", (3,), "f8", external=[(tmp_path / "x.bin", 0, 24)])

    source = written(write)
    assert list(source.columns) == ["same", "x"]
    assert str(tmp_path / "other.h5") in source.others["outside"]
    assert "/gone" in source.others["nowhere"]
    assert {"virtual", "raw"} < set(source.others)


def test_group_that_holds_itself_is_refused(written):
    def write(file):
        file["x"] = np.arange(5.0)
        file["group/again"] = file["/"]

    with pytest.raises(LogError):
        written(write)


def test_dataset_that_cannot_be_read_leaves_the_others(written, tmp_path):
    def write(file):
        file["x"] = np.arange(5.0)
        file.create_dataset("bad", data=np.arange(5.0), chunks=(5,), fletcher32=True)

    written(write)
    path = tmp_path / "log.h5"
    with h5py.File(path) as file:
        at = file["bad"].id.get_chunk_info(0).byte_offset
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content)
    source = read_arrays(path, matlab=False)
    assert (list(source.columns), list(source.others)) == (["x"], ["bad"])


@pytest.mark.parametrize(
    "declared",
    [{"shape": (10**5, 10**4), "chunks": (100, 100), "fillvalue": 1.0}, {"shape": (10**6,)}],
)
def test_dataset_that_declares_too_much_or_was_never_written_is_not_read(written, declared):
    def write(file):
        file["t"] = np.arange(10.0)
        file.create_dataset("x", dtype="f8", **declared)
        file.create_dataset("y", shape=(10, 6), dtype="f8", chunks=(5, 2))[:, :4] = 1.0

    source = written(write)
    assert list(source.columns) == ["t"]
    assert f"declares {np.prod(declared['shape']):,} numbers" in source.others["x"]
    assert "declares 60 numbers, but not all were" in source.others["y"]
