import importlib.util
import struct
import zlib
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io
from hypothesis import given
from hypothesis import strategies as st

from fprc.errors import LogError
from fprc.logs import hdf5_source, matlab
from fprc.logs.matlab import elements
from fprc.logs.sources import read_arrays
from fprc.logs.variables import columns_of, pick

_spec = importlib.util.spec_from_file_location(
    "matlab_files", Path(__file__).parents[1] / "matlab_files.py"
)
files = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(files)
Cells, Structs = files.Cells, files.Structs

Y = np.arange(50.0).reshape(-1, 1)
WRITERS = {"5": files.write_matlab5, "7.3": files.write_matlab73}


@pytest.fixture(params=WRITERS)
def read(request, tmp_path):
    """Write variables as a version of MATLAB does, and return the source read."""

    def read(content):
        WRITERS[request.param](tmp_path / "log.mat", content)
        source = read_arrays(tmp_path / "log.mat", matlab=True)
        assert source.kind == f"MATLAB {request.param}"
        return source

    return read


def columns(source):
    return {name: values.tolist() for name, values in columns_of(source).items()}


def test_parts_have_the_names_that_matlab_gives_them(read):
    """Every name listed can be used in a map."""
    steps = [{"y": k * Y, "u": {"p": -k * Y}} for k in (1, 2, 3)]
    source = read(
        {
            "x": Y,
            "train": Cells((1, 3), steps),
            "test": Structs((3, 1), steps),
            "grid": Cells((2, 2), [1 * Y, 2 * Y, 3 * Y, 4 * Y]),
            "deep": {"a": {"b": Cells((2, 1), [Y, {"c": Structs((1, 2), steps[:2])}])}},
            "one": Cells((1, 1), [Y]),
            "q": np.arange(6.0).reshape(3, 2),
        }
    )
    y = Y.ravel()
    expected = {"x": y, "one{1}": y, "deep.a.b{1}": y}
    for k in (1, 2, 3):
        expected |= {f"train{{{k}}}.y": k * y, f"train{{{k}}}.u.p": -k * y}
        expected |= {f"test({k}).y": k * y, f"test({k}).u.p": -k * y}
    for k in (1, 2):
        expected |= {f"deep.a.b{{2}}.c({k}).y": k * y, f"deep.a.b{{2}}.c({k}).u.p": -k * y}
    expected |= {"grid{1,1}": y, "grid{2,1}": 2 * y, "grid{1,2}": 3 * y, "grid{2,2}": 4 * y}
    expected |= {"q[:, 0]": np.array([0.0, 2.0, 4.0]), "q[:, 1]": np.array([1.0, 3.0, 5.0])}
    assert columns(source) == {name: values.tolist() for name, values in expected.items()}
    assert all(pick(source, name).tolist() == values.tolist() for name, values in expected.items())
    assert source.others == {}


def test_table_as_a_struct_array_of_rows_is_columns(read):
    rows = [{"Time": 0.1 * k, "p": 2.0 * k, "note": "a" if k < 3 else "b"} for k in range(5)]
    source = read({"tt": Structs((5, 1), rows)})
    assert columns(source) == {
        "[tt.Time]": [row["Time"] for row in rows],
        "[tt.p]": [row["p"] for row in rows],
    }
    assert source.others["tt(2).note"] == "text"


def test_empty_and_non_numeric_parts_leave_the_rest_of_the_file(read):
    nothing = np.zeros((0, 0))
    source = read(
        {
            "x": Y,
            "none": nothing,
            "cell": Cells((0, 0), []),
            "cells": Cells((1, 2), [nothing, Y]),
            "s": Structs((0, 0), []),
            "run": {"a": nothing, "b": Y},
            "name": "arm",
            "video": np.zeros((2, 3, 4)),
            "rate": np.ones((1, 1)),
        }
    )
    assert sorted(columns(source)) == ["cells{2}", "run.b", "x"]
    others = dict(source.others)
    assert "of shape" in others.pop("video")
    assert "of shape" in others.pop("rate")
    assert others == {
        "none": "empty", "cell": "empty", "cells{1}": "empty", "s": "empty", "run.a": "empty",
        "name": "text",
    }  # fmt: skip


def test_column_of_a_matrix_is_chosen_by_its_index_from_zero(read):
    values = np.arange(30.0).reshape(10, 3)
    source = read({"run": Cells((1, 2), [{"q": values}, {"q": 2.0 * values}])})
    assert pick(source, "run{2}.q[:, 2]").tolist() == (2.0 * values[:, 2]).tolist()
    assert pick(source, "run{1}.q[4,:]").tolist() == values[4].tolist()
    assert list(columns_of(source))[:3] == [f"run{{1}}.q[:, {j}]" for j in range(3)]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("run.q", "has 10 rows and 3 columns; choose one of them, such as run.q[:, 0]"),
        ("run.q[:, 3]", "has shape (10, 3); indices count from 0"),
        ("run.q[:, :]", "has shape (10, 3)"),
        ("run.q[1, 1]", "no such column"),
        ("run.Q[:, 1]", "did you mean run.q[:, 1]?"),
        ("run(3).y", "did you mean run(1).y?"),
        ("name", "cannot be a channel: text"),
    ],
)
def test_wrong_column_is_refused_with_the_right_ones(read, text, said):
    content = {"run": {"q": np.arange(30.0).reshape(10, 3)}, "name": "arm"}
    if text.startswith("run("):
        content = {"run": Structs((1, 2), [{"y": Y}] * 2), "name": "arm"}
    with pytest.raises(LogError) as caught:
        pick(read(content), text)
    assert said in str(caught.value)


@given(shape=st.lists(st.integers(1, 4), min_size=2, max_size=3).map(tuple))
def test_elements_are_counted_down_the_columns_from_one(shape):
    counted = np.arange(np.prod(shape)).reshape(shape, order="F")
    found = list(elements(shape))
    assert [counted[index] for index, _ in found] == list(range(counted.size))
    if sum(n > 1 for n in shape) < 2:
        assert [text for _, text in found] == [str(k + 1) for k in range(counted.size)]
    else:
        assert [text for _, text in found] == [
            ",".join(str(i + 1) for i in index) for index, _ in found
        ]


# --- what is refused ------------------------------------------------------------------------


def compressed(element):
    packed = zlib.compress(element, 9)
    head = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x100) + b"IM"
    return head + struct.pack("<II", 15, len(packed)) + packed


def test_compressed_file_is_refused_by_its_unpacked_size(tmp_path, monkeypatch):
    path = tmp_path / "bomb.mat"
    path.write_bytes(compressed(bytes(3 << 20)))
    assert path.stat().st_size < 1 << 13
    monkeypatch.setattr(matlab, "MOST_NUMBERS", (2 << 20) // 8)
    monkeypatch.setattr(scipy.io, "loadmat", None)
    with pytest.raises(LogError, match=r"bomb\.mat: its variables need more than 2 MB"):
        read_arrays(path, matlab=True)


def test_file_of_more_parts_than_can_be_meant_is_refused(read, monkeypatch):
    monkeypatch.setattr(matlab, "MOST_VARIABLES", 9)
    monkeypatch.setattr(hdf5_source, "MOST_OBJECTS", 9)
    with pytest.raises(LogError, match="more than 9 "):
        read({"c": Cells((1, 10), [Y] * 10)})


def test_cell_that_holds_itself_is_refused(tmp_path):
    files.write_matlab73(tmp_path / "log.mat", {"c": Cells((1, 1), [Y])})
    with h5py.File(tmp_path / "log.mat", "r+") as file:
        file["c"][...] = file["c"].ref
    with pytest.raises(LogError, match="cannot be read as HDF5"):
        read_arrays(tmp_path / "log.mat", matlab=True)


def test_objects_of_matlab_are_no_columns(tmp_path):
    """A table, a sparse matrix, a string: MATLAB does not store them as samples."""
    files.write_matlab73(tmp_path / "log.mat", {"x": Y, "tt": np.arange(6.0), "s": {"data": Y}})
    with h5py.File(tmp_path / "log.mat", "r+") as file:
        file["tt"].attrs["MATLAB_class"] = np.bytes_("timetable")
        file["s"].attrs["MATLAB_sparse"] = np.uint64(9)
    source = read_arrays(tmp_path / "log.mat", matlab=True)
    assert list(source.variables) == ["x"]
    assert "a MATLAB timetable; save" in source.others["tt"]
    assert "save full(...)" in source.others["s"]
