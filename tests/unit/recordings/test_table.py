"""Arrays of MATLAB and HDF5, and which format a file is of."""

import calendar
import re

import h5py
import numpy as np
import pandas as pd
import pytest
import scipy.sparse
from matio import save_to_mat
from matio.utils.matclass import MatlabOpaque

from fprc.errors import LogError
from fprc.recordings.table import read_table

Y = np.arange(50.0).reshape(-1, 1)
COLUMNS = {"t": Y.ravel() / 100.0, "angle": np.sin(Y.ravel()), "force": Y.ravel() ** 2}


@pytest.fixture(params=["5", "7.3"])
def read(request, tmp_path, matlab_files):
    """Write variables as a version of MATLAB does, and return the table read."""
    writers = {"5": matlab_files.write_matlab5, "7.3": matlab_files.write_matlab73}

    def read(content):
        writers[request.param](tmp_path / "log.mat", content)
        return read_table(tmp_path / "log.mat")

    return read


def columns(table):
    return {name: column.values.tolist() for name, column in table.columns.items()}


def refusal(path):
    with pytest.raises(LogError) as caught:
        read_table(path)
    return str(caught.value)


def test_parts_have_the_names_that_matlab_gives_them(read, matlab_files):
    """Every name listed can be used in a map."""
    Cells, Structs = matlab_files.Cells, matlab_files.Structs  # noqa: N806
    steps = [{"y": k * Y, "u": {"p": -k * Y}} for k in (1, 2, 3)]
    table = read(
        {
            "x": Y,
            "train": Cells((1, 3), steps),
            "grid": Cells((2, 2), [1 * Y, 2 * Y, 3 * Y, 4 * Y]),
            "deep": {"a": {"b": Cells((2, 1), [Y, {"c": steps[0]}])}},
            "run": Structs((1, 2), [{"p": Y}, {"p": 2 * Y}]),
            "q": np.arange(6.0).reshape(3, 2),
        }
    )
    y = Y.ravel()
    expected = {"x": y, "deep.a.b{1}": y, "run(1).p": y, "run(2).p": 2 * y}
    for k in (1, 2, 3):
        expected |= {f"train{{{k}}}.y": k * y, f"train{{{k}}}.u.p": -k * y}
    expected |= {"deep.a.b{2}.c.y": y, "deep.a.b{2}.c.u.p": -y}
    expected |= {f"grid{{{k}}}": k * y for k in (1, 2, 3, 4)}
    expected |= {"q[:, 0]": np.array([0.0, 2.0, 4.0]), "q[:, 1]": np.array([1.0, 3.0, 5.0])}
    assert columns(table) == {name: values.tolist() for name, values in expected.items()}


def test_what_is_no_column_of_matlab_leaves_the_rest_and_is_told(read, matlab_files):
    nothing, q = np.zeros((0, 0)), np.arange(30.0).reshape(10, 3)
    table = read(
        {
            "run": {"q": q, "y": Y, "a": nothing},
            "cells": matlab_files.Cells((1, 2), [nothing, Y]),
            "name": "arm",
            "video": np.zeros((2, 3, 4)),
            "rate": np.ones((1, 1)),
        }
    )
    assert sorted(table.columns) == ["cells{2}", *(f"run.q[:, {k}]" for k in range(3)), "run.y"]
    assert {"cells{1}", "run.a", "video", "rate"} <= set(table.others)
    for name in ("run.q", "run(3).y", "run.a"):
        with pytest.raises(LogError, match=re.escape(name)):
            table.pick({"theta_deg": name})


def test_timeseries_of_matlab_are_numbers_or_one_line_says_how_to_save_them(tmp_path):
    """Data and times as properties, or in objects that mat-io does not read."""
    times = MatlabOpaque({"Data_": Y, "Time_": Y / 100.0}, "timeseries")
    empty = MatlabOpaque({"Name": "angle"}, "timeseries")
    save_to_mat(str(tmp_path / "log.mat"), {"angle": times, "p": empty}, version="v7.3")
    table = read_table(tmp_path / "log.mat")
    assert list(table.columns) == ["angle.Data_", "angle.Time_"]
    assert "a timeseries of MATLAB; save its times and values as a struct" in table.others["p"]


@pytest.mark.parametrize("version", ["v7", "v7.3"])
def test_tables_and_times_are_columns_and_other_objects_are_not(version, tmp_path):
    p = [1.5, 2.5, 4.0]
    steps = pd.to_timedelta([0, 5, 10], "ms").as_unit("ns").rename("Time")
    dates = pd.to_datetime(["2024-03-01T12:00:00.000", "2024-03-01T12:00:00.005", None])
    content = {
        "tt": pd.DataFrame({"p": p}, index=steps),
        "run": pd.DataFrame({"p": p, "at": dates.as_unit("ns"), "note": list("abc")}),
        "s": scipy.sparse.eye_array(5).tocsc(),
        "x": Y,
    }
    save_to_mat(str(tmp_path / "log.mat"), content, version=version)
    table = read_table(tmp_path / "log.mat")
    noon = calendar.timegm((2024, 3, 1, 12, 0, 0))
    found = columns(table)
    assert found.pop("run.at") == pytest.approx([noon, noon + 0.005, np.nan], abs=1e-6, nan_ok=True)
    assert found == {"tt.Time": [0, 0.005, 0.01], "tt.p": p, "run.p": p, "x": Y.ravel().tolist()}
    assert {"run.note", "s"} <= set(table.others)


def test_what_is_no_column_of_hdf5_leaves_the_others(tmp_path):
    path = tmp_path / "log.h5"
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["y"] = np.arange(3.0)
    with h5py.File(path, "w") as file:
        file["group/x"] = np.arange(5)
        file["on"] = np.arange(5) > 2
        file["row"] = np.zeros((1, 5))
        file["video"] = np.zeros((4, 3, 3))
        file["who"] = "me"
        file["rate"] = 100.0
        file["none"] = h5py.Empty("f8")
        layout = h5py.VirtualLayout((3,), "f8")
        layout[:] = h5py.VirtualSource(tmp_path / "other.h5", "y", (3,))
        file.create_virtual_dataset("virtual", layout)
        file.create_dataset("raw", (3,), "f8", external=[(tmp_path / "x.bin", 0, 24)])
        file.create_dataset("huge", (10**5, 10**4), "f8", chunks=(100, 100), fillvalue=1.0)
        file.create_dataset("part", (10, 6), "f8", chunks=(5, 2))[:, :4] = 1.0
        bad = file.create_dataset("bad", data=np.arange(5.0), chunks=(5,), fletcher32=True)
        at = bad.id.get_chunk_info(0).byte_offset
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content)
    table = read_table(path)
    assert {n: c.values.shape for n, c in table.columns.items()} == dict.fromkeys(
        ("group/x", "on", "row"), (5,)
    )
    assert set(table.others) == {
        "video", "who", "rate", "none", "virtual", "raw", "huge", "part", "bad",
    }  # fmt: skip


def test_names_beside_a_matrix_are_those_of_its_columns(tmp_path):
    """As an attribute, as an array of texts, and as pandas writes them; others name nothing."""
    matrix, names = np.arange(12.0).reshape(4, 3), ["t", "Winkel °", "p"]
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file["run"], file["few"] = matrix, matrix
        file["run"].attrs["columns"], file["few"].attrs["names"] = names, names[:2]
        file["df/block0_values"], file["df/block0_items"] = matrix, [n.encode() for n in names]
    phase = np.array(list("abcd"))
    np.savez(tmp_path / "log.npz", phase=phase, names=np.array(names), up=matrix, flat=matrix.T)
    named = {f".{name}": matrix[:, k].tolist() for k, name in enumerate(names)}
    found = columns(read_table(tmp_path / "log.h5")) | columns(read_table(tmp_path / "log.npz"))
    for k, values in enumerate(named.values()):
        assert found.pop(f"few[:, {k}]") == values
    places = ("run", "df/block0_values", "up", "flat")
    assert found == {f"{place}{n}": values for place in places for n, values in named.items()}


@pytest.mark.parametrize("kind", ["hdf5", "matlab5", "matlab73", "npz", "xlsx"])
def test_file_cut_anywhere_is_refused_with_its_name(kind, tmp_path, matlab_files):
    path = tmp_path / "whole"
    if kind == "hdf5":
        with h5py.File(path, "w") as file:
            for name, values in COLUMNS.items():
                file[name] = values
    elif kind == "npz":
        np.savez(tmp_path / "whole.npz", **COLUMNS)
        (tmp_path / "whole.npz").rename(path)
    elif kind == "xlsx":
        pd.DataFrame(COLUMNS).to_excel(tmp_path / "a.xlsx", index=False)
        (tmp_path / "a.xlsx").rename(path)
    else:
        path = tmp_path / "whole.mat"
        getattr(matlab_files, f"write_{kind}")(path, COLUMNS)
    whole, cut = path.read_bytes(), path.with_stem("cut")
    assert len(read_table(path).columns) == 3
    for size in range(0, len(whole), len(whole) // 25):
        cut.write_bytes(whole[:size])
        assert refusal(cut).startswith(f"{cut}: ")


@pytest.mark.parametrize(
    ("content", "remedy"),
    [
        (b"\xd0\xcf\x11\xe0" + bytes(60) + b"\xff" * 600, "save it as .csv"),
        (b"\0\1\2\3" * 50, "save it as .csv"),
    ],
)
def test_format_that_is_not_read_is_named_with_a_way_out(tmp_path, content, remedy):
    (tmp_path / "log.dat").write_bytes(content)
    assert remedy in refusal(tmp_path / "log.dat")


def test_library_that_is_not_installed_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "nptdms", None)
    (tmp_path / "log.tdms").write_bytes(b"TDSm" + bytes(60))
    assert "pip install 'fprc[formats]'" in refusal(tmp_path / "log.tdms")
