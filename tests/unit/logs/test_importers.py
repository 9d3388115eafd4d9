import subprocess
import sys

import h5py
import numpy as np
import pandas as pd
import pytest
import scipy.io
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fprc.errors import LogError
from fprc.logs.importers import FACTORS, gather
from fprc.logs.sources import read_source
from fprc.logs.variables import columns_of, pick

PLAIN = {"scale": 1.0, "offset": 0.0}
T = np.arange(50) / 100.0
COLUMNS = {"t": T, "angle": np.sin(T), "force": np.arange(50.0) ** 2}


def write_csv(path, columns, separator=","):
    pd.DataFrame(columns).to_csv(path, index=False, sep=separator)


def write_hdf5(path, columns):
    with h5py.File(path, "w") as file:
        for name, values in columns.items():
            file[f"run/{name}"] = values


def write_matlab(path, columns):
    scipy.io.savemat(path, {"run": dict(columns)}, do_compression=True)


def write_matlab73(path, columns):
    """Write what MATLAB's -v7.3 writes: HDF5 behind a text of 512 bytes, arrays by columns."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in columns.items():
            dataset = file.create_dataset(f"run/{name}", data=np.atleast_2d(values))
            dataset.attrs["MATLAB_class"] = np.bytes_("double")
        file["#refs#/a"] = [1.0]
        file["label"] = np.array([[104], [105]], dtype=np.uint16)
        file["label"].attrs["MATLAB_class"] = np.bytes_("char")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\0\2IM")


WRITERS = {
    "csv": (write_csv, "log.csv", "{}"),
    "hdf5": (write_hdf5, "log.h5", "run/{}"),
    "matlab": (write_matlab, "log.mat", "run.{}"),
    "matlab73": (write_matlab73, "new.mat", "run.{}"),
}
numbers = st.floats(-1e9, 1e9, allow_subnormal=False)


def problem(call, *arguments, **named):
    with pytest.raises(LogError) as caught:
        call(*arguments, **named)
    return str(caught.value)


@pytest.fixture(params=WRITERS)
def source(request, tmp_path):
    """The same three columns in each format, as (source, name in the format)."""
    write, file, name = WRITERS[request.param]
    write(tmp_path / file, COLUMNS)
    return read_source(tmp_path / file), name


def asked(name, **more):
    """Arguments that ask for angle and force on the clock t."""
    spec = {
        "theta_deg": {"column": name.format("angle"), "unit": "deg", **PLAIN},
        "p_exp_kpa": {"column": name.format("force"), "unit": "1", **PLAIN},
    }
    return {"time": {"column": name.format("t"), "unit": "s"}, "channels": spec} | more


# --- every format ---------------------------------------------------------------------------


def test_channels_come_back_from_every_format(source):
    content, name = source
    recording = gather(content, **asked(name))
    assert recording.time_s.tolist() == T.tolist()
    assert recording.channels["theta_deg"].tolist() == COLUMNS["angle"].tolist()
    assert recording.channels["p_exp_kpa"].tolist() == COLUMNS["force"].tolist()


@pytest.mark.parametrize("kind", WRITERS)
@given(values=arrays(np.float64, st.integers(2, 30), elements=numbers))
def test_any_numbers_come_back_bit_for_bit(kind, values, tmp_path_factory):
    write, file, name = WRITERS[kind]
    path = tmp_path_factory.getbasetemp() / f"any_{file}"
    write(path, {"angle": values, "force": -values})
    channels = asked(name)["channels"]
    recording = gather(read_source(path), time={"rate_hz": 10.0}, channels=channels)
    assert recording.channels["theta_deg"].tolist() == values.tolist()
    assert recording.channels["p_exp_kpa"].tolist() == (-values).tolist()
    assert recording.time_s == pytest.approx(np.arange(len(values)) / 10.0)


def test_unknown_column_is_answered_by_the_nearest(source):
    content, name = source
    wrong = asked(name)
    wrong["channels"]["theta_deg"]["column"] = name.format("Angel")
    wrong["channels"]["p_exp_kpa"]["column"] = name.format("forces")
    lines = problem(gather, content, **wrong).splitlines()
    assert len(lines) == 2
    assert f"{content.path}: theta_deg: {name.format('Angel')}: no such column" in lines[0]
    assert f"did you mean {name.format('angle')}?" in lines[0]
    assert f"did you mean {name.format('force')}?" in lines[1]


def test_value_that_is_kept_and_not_finite_is_named_with_its_sample(tmp_path):
    force = COLUMNS["force"].copy()
    force[[30, 40]] = np.nan
    for write, file, name in WRITERS.values():
        write(tmp_path / file, COLUMNS | {"force": force})
        content = read_source(tmp_path / file)
        said = problem(gather, content, **asked(name, start_s=0.1))
        assert f"p_exp_kpa: {name.format('force')}: sample 30 is nan, and 1 more" in said
        assert len(gather(content, **asked(name, end_s=0.295)).time_s) == 30


# --- text -----------------------------------------------------------------------------------


@pytest.mark.parametrize("separator", [",", ";", "\t", "|", " "])
def test_separator_is_found_out(tmp_path, separator):
    write_csv(tmp_path / "log.txt", COLUMNS, separator)
    assert list(columns_of(read_source(tmp_path / "log.txt"))) == list(COLUMNS)


def test_decimal_comma_is_found_out(tmp_path):
    path = tmp_path / "log.csv"
    pd.DataFrame(COLUMNS).to_csv(path, index=False, sep=";", decimal=",")
    assert pick(read_source(path), "angle").tolist() == COLUMNS["angle"].tolist()


def test_decimal_commas_between_commas_are_refused(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t_ms,p_set,p_o\n0,1,0,50,1\n5,1,1,50,2\n10,1,2,50,3\n")
    assert "csv.separator" in problem(read_source, path)


@pytest.mark.parametrize("numbers", [["990", "999", "1,000"], ["1.5", "1,5", "2"]])
def test_comma_that_may_be_of_thousands_is_no_number_until_it_is_said(tmp_path, numbers):
    path = tmp_path / "log.csv"
    path.write_text("t;p\n" + "".join(f"{k};{text}\n" for k, text in enumerate(numbers)))
    source = read_source(path)
    assert "csv.decimal" in source.others["p"]
    assert "t" in source.variables


def test_three_digits_after_every_comma_are_decimals(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t;p\n0;1,250\n1;1,500\n")
    assert pick(read_source(path), "p").tolist() == [1.25, 1.5]


def test_text_without_header_is_numbered(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("0,1.5\n1,2.5\n2,3.5\n")
    assert pick(read_source(path), "1").tolist() == [1.5, 2.5, 3.5]


def test_comments_marks_quotes_and_foreign_letters_do_no_harm(tmp_path):
    path = tmp_path / "log.csv"
    path.write_bytes(b'# made in 2019\n\n"t","angle [\xb0]"\n0, 1.5\n1, 2.5\n\n')
    assert list(columns_of(read_source(path))) == ["t", "angle [\xb0]"]
    path.write_bytes("\ufefft,x\n0,1\n1,2\n".encode())
    assert list(columns_of(read_source(path))) == ["t", "x"]


def test_lines_of_header_and_data_may_be_given(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("made by a logger, version 3\nt,x\ns,mm\n0,1.5\n1,2.5\n")
    content = read_source(path, header_line=2, data_line=4)
    assert pick(content, "x").tolist() == [1.5, 2.5]


def test_column_that_is_no_number_is_named_with_its_line(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t,x\n0,1.5\n1,off\n2,3.5\n")
    assert "x: cannot be a channel: line 3 holds 'off', not a number" in problem(
        pick, read_source(path), "x"
    )


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "no samples"),
        ("t,x\n", "no samples below line 1"),
        ("t,x\n0,1\n1,2,3\n", "cannot be read as text of 2 columns from line 2"),
        ("t,t\n0,1\n1,2\n", "column t: is there twice"),
        ("t,x\0\n", "not a text file"),
    ],
)
def test_text_that_is_no_table_is_refused(tmp_path, content, said):
    path = tmp_path / "log.csv"
    path.write_text(content)
    assert f"{path}: " in problem(read_source, path)
    assert said in problem(read_source, path)


def test_short_line_is_a_missing_value_at_its_sample(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t,angle,force\n0,1,1\n1,2\n2,3,3\n")
    assert "force: sample 1 is nan" in problem(gather, read_source(path), **asked("{}"))


# --- HDF5 and MATLAB ------------------------------------------------------------------------


@pytest.fixture(params=["matlab", "matlab73"])
def matrix(request, tmp_path):
    """A matrix of three columns, as MATLAB's old and new formats keep it."""
    values = np.arange(30.0).reshape(10, 3)
    path = tmp_path / "log.mat"
    if request.param == "matlab":
        scipy.io.savemat(path, {"run": {"q": values}, "name": "arm"})
    else:
        write_matlab73(path, {"q": values.T})
    return read_source(path), values


def test_column_of_a_matrix_is_chosen_by_its_index(matrix):
    source, values = matrix
    assert pick(source, "run.q[:, 2]").tolist() == values[:, 2].tolist()
    assert pick(source, "run.q[4,:]").tolist() == values[4].tolist()
    assert list(columns_of(source)) == [f"run.q[:, {j}]" for j in range(3)]


def test_text_beside_the_arrays_is_listed_as_no_channel(matrix):
    source, _ = matrix
    (name,) = source.others
    assert "cannot be a channel" in problem(pick, source, name)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("run.q", "has 10 rows and 3 columns; choose one, as run.q[:, 0]"),
        ("run.q[:, 3]", "has shape (10, 3); indices count from 0"),
        ("run.q[:, :]", "has shape (10, 3)"),
        ("run.q[1, 1]", "no such column"),
        ("run.Q[:, 1]", "did you mean run.q[:, 1]?"),
    ],
)
def test_wrong_index_is_told_the_shape(matrix, text, said):
    assert said in problem(pick, matrix[0], text)


@pytest.mark.parametrize("shape", [(50,), (50, 1), (1, 50)])
def test_rows_and_columns_are_vectors_alike(tmp_path, shape):
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file["x"] = np.arange(50.0).reshape(shape)
    assert pick(read_source(tmp_path / "log.h5"), "x").tolist() == list(range(50))


def test_pictures_texts_and_single_numbers_are_no_channels(tmp_path):
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file["video"] = np.zeros((4, 3, 3))
        file["who"] = "me"
        file["rate"] = 100.0
        file["x"] = np.arange(5)
    source = read_source(tmp_path / "log.h5")
    assert list(source.variables) == ["x"]
    assert set(source.others) == {"video", "who", "rate"}


def test_cell_array_of_unlike_things_leaves_the_rest_of_the_file(tmp_path):
    cells = np.empty(2, dtype=object)
    cells[:] = [{"a": 1.0}, np.arange(5.0)]
    scipy.io.savemat(tmp_path / "log.mat", {"c": cells, "x": np.arange(4.0)})
    source = read_source(tmp_path / "log.mat")
    assert list(source.variables) == ["x"]
    assert list(source.others) == ["c"]


READ_DAMAGED = """
import sys
from pathlib import Path
from fprc.errors import LogError
from fprc.logs.sources import read_source

path = Path(sys.argv[1])
whole = path.read_bytes()
damaged = path.with_stem("damaged")
for cut in sorted({128, *range(0, len(whole), max(len(whole) // 60, 1))}):
    damaged.write_bytes(whole[:cut])
    try:
        read_source(damaged)
    except LogError as error:
        print("LogError" if str(error).startswith(str(damaged)) else str(error))
    except BaseException as error:
        print(cut, type(error).__name__, error)
    else:
        print("read")
"""


@pytest.mark.parametrize("kind", ["hdf5", "matlab", "matlab73"])
def test_file_cut_anywhere_is_refused_with_a_message_and_never_hangs(tmp_path, kind):
    write, file, _ = WRITERS[kind]
    write(tmp_path / file, COLUMNS)
    run = subprocess.run(
        [sys.executable, "-c", READ_DAMAGED, str(tmp_path / file)],
        capture_output=True, text=True, timeout=60, check=True,
    )  # fmt: skip
    assert set(run.stdout.splitlines()) == {"LogError"}


@pytest.mark.parametrize("name", ["log.h5", "log.mat", "log.csv"])
def test_absent_file_is_named(tmp_path, name):
    assert f"{tmp_path / name}: cannot be opened" in problem(read_source, tmp_path / name)


def test_unknown_ending_is_answered_by_the_known_ones(tmp_path):
    assert "must be one of .csv" in problem(read_source, tmp_path / "log.xlsx")


@pytest.mark.parametrize("name", ["log.h5", "log.mat"])
def test_text_under_another_ending_is_refused(tmp_path, name):
    write_csv(tmp_path / name, COLUMNS)
    assert f"{tmp_path / name}: " in problem(read_source, tmp_path / name)


# --- clock, cut, units ----------------------------------------------------------------------


@pytest.fixture
def csv(tmp_path):
    def read(**columns):
        write_csv(tmp_path / "log.csv", COLUMNS | columns)
        return read_source(tmp_path / "log.csv")

    return read


@pytest.mark.parametrize(("unit", "per_s"), [("s", 1), ("ms", 1e3), ("us", 1e6), ("min", 1 / 60)])
def test_clock_of_any_unit_and_start_counts_from_zero(csv, unit, per_s):
    source = csv(t=(T + 3600.0) * per_s)
    told = asked("{}") | {"time": {"column": "t", "unit": unit}}
    recording = gather(source, **told)
    assert recording.time_s == pytest.approx(T, abs=1e-9)
    assert recording.start_s == pytest.approx(3600.0)


def test_clock_that_counts_from_1970_keeps_its_microseconds(csv):
    source = csv(t=np.arange(50) * 5000 + 1_700_000_000_000_000)
    recording = gather(source, **asked("{}") | {"time": {"column": "t", "unit": "us"}})
    assert np.diff(recording.time_s) == pytest.approx(0.005, abs=1e-12)


@pytest.mark.parametrize("wrong", [0.04, 0.05])
def test_clock_that_does_not_increase_is_named_with_its_sample(csv, wrong):
    t = T.copy()
    t[6] = wrong
    said = problem(gather, csv(t=t), **asked("{}"))
    assert f"time: t: sample 6 at {wrong} does not come after 0.05, and 0 more" in said


def test_clock_with_a_hole_is_named_with_its_sample(csv):
    t = T.copy()
    t[6] = np.nan
    assert "time: t: sample 6 is nan" in problem(gather, csv(t=t), **asked("{}"))


def test_cut_is_counted_from_the_first_sample(csv):
    recording = gather(csv(t=T + 5.0), **asked("{}", start_s=0.1, end_s=0.2))
    assert recording.time_s == pytest.approx(np.arange(11) / 100.0)
    assert recording.channels["p_exp_kpa"].tolist() == COLUMNS["force"][10:21].tolist()
    assert recording.start_s == pytest.approx(5.1)


def test_cut_that_leaves_nothing_says_how_long_the_file_is(csv):
    said = problem(gather, csv(), **asked("{}", start_s=9.0))
    assert "0 samples lie between start_s = 9" in said
    assert "50, over 0.49 s" in said


def test_unequal_columns_are_counted(tmp_path):
    write_hdf5(tmp_path / "log.h5", COLUMNS | {"force": np.zeros(49)})
    said = problem(gather, read_source(tmp_path / "log.h5"), **asked("run/{}"))
    assert "unequal numbers of samples (run/t 50, run/angle 50, run/force 49)" in said


@pytest.mark.parametrize(
    ("unit", "one"),
    [
        ("kPa", 1.0), ("Pa", 0.001), ("mbar", 0.1), ("bar", 100.0), ("MPa", 1000.0),
        ("psi", 6.894757), ("deg", 1.0), ("rad", 57.29578), ("V", 1.0), ("mV", 0.001), ("1", 1.0),
    ],
)  # fmt: skip
def test_one_of_each_unit(unit, one):
    assert FACTORS[unit] == pytest.approx(one, rel=1e-7)


def test_scale_and_offset_come_before_the_unit(csv):
    """1 to 5 V of a sensor of 0 to 1 MPa; absolute bar."""
    told = asked("{}")
    told["channels"]["theta_deg"] |= {"unit": "kPa", "scale": 250.0, "offset": -250.0}
    told["channels"]["p_exp_kpa"] |= {"unit": "bar", "offset": -1.01325}
    recording = gather(csv(), **told)
    assert recording.channels["theta_deg"] == pytest.approx((COLUMNS["angle"] - 1.0) * 250.0)
    assert recording.channels["p_exp_kpa"] == pytest.approx(100 * COLUMNS["force"] - 101.325)
