import h5py
import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fprc.errors import LogError
from fprc.logs.columns import LARGEST
from fprc.recordings.arrays import read_arrays
from fprc.recordings.gather import gather, read_source

PLAIN = {"scale": 1.0, "offset": 0.0}
T = np.arange(50) / 100.0
COLUMNS = {"t": T, "angle": np.sin(T), "force": np.arange(50.0) ** 2}


def write_csv(path, columns, separator=","):
    pd.DataFrame(columns).to_csv(path, index=False, sep=separator)


def write_hdf5(path, columns):
    with h5py.File(path, "w") as file:
        for name, values in columns.items():
            file[f"run/{name}"] = values


KINDS = ("csv", "hdf5", "matlab5", "matlab73")


@pytest.fixture(scope="session")
def writers(matlab_files):
    """By kind: what writes columns to a file, its name, and their names in it."""

    def nested(write):
        return lambda path, columns: write(path, {"run": dict(columns)})

    return {
        "csv": (write_csv, "log.csv", "{}"),
        "hdf5": (write_hdf5, "log.h5", "run/{}"),
        "matlab5": (nested(matlab_files.write_matlab5), "log.mat", "run.{}"),
        "matlab73": (nested(matlab_files.write_matlab73), "new.mat", "run.{}"),
    }


numbers = st.floats(-1e9, 1e9, allow_subnormal=False)


def problem(call, *arguments, **named):
    with pytest.raises(LogError) as caught:
        call(*arguments, **named)
    return str(caught.value)


@pytest.fixture(params=KINDS)
def source(request, tmp_path, writers):
    """The same three columns in each format, as (source, name in the format)."""
    write, file, name = writers[request.param]
    write(tmp_path / file, COLUMNS)
    return read_source(tmp_path / file), name


def asked(name, **more):
    """Arguments that map angle and force, with the clock t."""
    spec = {
        "theta_deg": {"column": name.format("angle"), "unit": "deg", **PLAIN},
        "p_exp_kpa": {"column": name.format("force"), "unit": "1", **PLAIN},
    }
    return {"time": {"column": name.format("t"), "unit": "s"}, "channels": spec} | more


# --- every format ---------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
@given(values=arrays(np.float64, st.integers(2, 30), elements=numbers))
def test_any_numbers_come_back_bit_for_bit(kind, values, writers, tmp_path_factory):
    write, file, name = writers[kind]
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


def test_value_that_is_kept_and_not_finite_is_named_with_its_sample(tmp_path, writers):
    force = COLUMNS["force"].copy()
    force[[30, 40]] = np.nan
    for write, file, name in writers.values():
        write(tmp_path / file, COLUMNS | {"force": force})
        content = read_source(tmp_path / file)
        message = problem(gather, content, **asked(name, start_s=0.1))
        assert (
            f"p_exp_kpa: {name.format('force')}: {content.sample(30)} is nan; not finite or beyond"
            in message
        )
        assert len(gather(content, **asked(name, end_s=0.295)).time_s) == 30


# --- files ----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS[1:])
def test_file_cut_anywhere_is_refused_with_a_message_and_never_hangs(tmp_path, writers, kind):
    write, file, _ = writers[kind]
    write(tmp_path / file, COLUMNS)
    whole, cuts = (tmp_path / file).read_bytes(), []
    for size in sorted({128, *range(0, len(whole), max(len(whole) // 60, 1))}):
        cuts.append((tmp_path / file).with_stem(f"cut_{size}"))
        cuts[-1].write_bytes(whole[:size])
    for path in cuts:
        assert problem(read_source, path).startswith(f"{path}: ")


def test_unknown_ending_is_answered_by_the_known_ones(tmp_path):
    with pytest.raises(LogError, match="must be one of .csv"):
        read_source(tmp_path / "log.xlsx")


@pytest.mark.parametrize("name", ["log.h5", "log.mat"])
def test_text_under_another_ending_is_refused(tmp_path, name):
    (tmp_path / name).write_text("t,angle\n0,1\n")
    with pytest.raises(LogError) as caught:
        read_arrays(tmp_path / name, matlab=name.endswith("mat"))
    assert str(caught.value).startswith(str(tmp_path / name))


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
    arguments = asked("{}") | {"time": {"column": "t", "unit": unit}}
    recording = gather(source, **arguments)
    assert recording.time_s == pytest.approx(T, abs=1e-9)
    assert recording.start_s == pytest.approx(3600.0)


def test_value_that_is_not_kept_may_be_missing(csv):
    force = COLUMNS["force"].copy()
    force[1] = np.nan
    gather(csv(force=force), **asked("{}", start_s=2.0 * T[1]))


def test_cut_is_counted_from_the_first_sample(csv):
    recording = gather(csv(t=T + 5.0), **asked("{}", start_s=0.1, end_s=0.2))
    assert recording.time_s == pytest.approx(np.arange(11) / 100.0)
    assert recording.channels["p_exp_kpa"].tolist() == COLUMNS["force"][10:21].tolist()
    assert recording.start_s == pytest.approx(5.1)


def test_cut_that_leaves_nothing_is_refused(csv):
    assert "log.csv: 0 samples lie" in problem(gather, csv(), **asked("{}", start_s=9.0))


def test_unequal_columns_are_counted(tmp_path):
    write_hdf5(tmp_path / "log.h5", COLUMNS | {"force": np.zeros(49)})
    message = problem(gather, read_source(tmp_path / "log.h5"), **asked("run/{}"))
    assert "unequal numbers of samples (run/t 50, run/angle 50, run/force 49)" in message


def test_scale_and_offset_come_before_the_unit(csv):
    """1 to 5 V of a sensor of 0 to 1 MPa; absolute bar."""
    arguments = asked("{}")
    arguments["channels"]["theta_deg"] |= {"unit": "kPa", "scale": 250.0, "offset": -250.0}
    arguments["channels"]["p_exp_kpa"] |= {"unit": "bar", "offset": -1.01325}
    recording = gather(csv(), **arguments)
    assert recording.channels["theta_deg"] == pytest.approx((COLUMNS["angle"] - 1.0) * 250.0)
    assert recording.channels["p_exp_kpa"] == pytest.approx(100 * COLUMNS["force"] - 101.325)


@pytest.mark.parametrize(
    "spec", [{"scale": 1e308}, {"scale": 1e308, "offset": 1e308}, {"unit": "MPa", "scale": 1e9}]
)
def test_value_that_scale_offset_and_unit_make_too_large_is_named(csv, spec):
    arguments = asked("{}")
    arguments["channels"]["p_exp_kpa"] |= spec
    message = problem(gather, csv(), **arguments)
    assert "p_exp_kpa: force: sample " in message
    assert f"beyond {LARGEST:g}" in message
    assert "nan" not in message


def test_all_missing_columns_are_reported_together_and_all_unusable_ones(csv):
    angle = COLUMNS["angle"].copy()
    angle[7] = np.inf
    arguments = asked("{}")
    arguments["time"]["column"] = "clock"
    arguments["channels"]["p_o_kpa"] = {"column": "pressure", "unit": "kPa", **PLAIN}
    lines = problem(gather, csv(angle=angle), **arguments).splitlines()
    assert [line.split(": ")[1:3] for line in lines] == [["time", "clock"], ["p_o_kpa", "pressure"]]
    arguments["time"]["column"] = "t"
    arguments["channels"]["p_o_kpa"] |= {"column": "force", "scale": 1e300}
    lines = problem(gather, csv(angle=angle), **arguments).splitlines()
    assert [line.split(": ")[1] for line in lines] == ["theta_deg", "p_o_kpa"]
