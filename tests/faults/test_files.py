"""Faults of files and settings, as a user meets them; each row holds the command's outcome."""

import json
import os
import re
import shutil
import struct
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io
import yaml

from fprc.config import from_files
from fprc.logs import write_raw

ROOT = Path(__file__).parents[2]
RATE_HZ = 200.0
IMPORTED = ["out.diagnosis.json", "out.diagnosis.png", "out.h5"]
IMPORT = ("--map", "map.yaml", "--out", "out.h5")
_IMPORTS, _LISTS = "fprc import --map --out", "fprc import --list"


def nothing_or(left):
    return ", ".join(left) or "nothing"


# --- recordings -----------------------------------------------------------------------------


def table(rows=300, rate_hz=RATE_HZ):
    """Columns of a recording: a clock, an angle, a pressure, another one."""
    time_s = np.arange(rows) / rate_hz
    wave = 1.0 - np.cos(2.0 * np.pi * time_s)
    return {"t": time_s, "angle": 30.0 * wave, "p": 170.0 * wave + 5.0, "z": 110.0 + 9.0 * wave}


def write_csv(path, columns, header=None, edit=lambda lines: None):
    rows = zip(*columns.values(), strict=True)
    lines = [header or ",".join(columns), *(",".join(map(repr, map(float, row))) for row in rows)]
    edit(lines)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_map(folder, time=None, **channels):
    told = {
        "experiment": "sweep",
        "time": time or {"column": "t"},
        "channels": {
            "theta_deg": {"column": "angle", "unit": "deg"},
            "p_exp_kpa": {"column": "p", "unit": "kPa"},
        }
        | channels,
    }
    (folder / "map.yaml").write_text(yaml.safe_dump(told))


def imported(folder):
    with h5py.File(folder / "out.h5") as file:
        return {name: file[name][()] for name in file}


def test_quoted_comma_in_a_header_shifts_no_column(user, files):
    columns = table()
    write_csv(user.folder / "arm.csv", columns, header='t,"a,deg",p,z')
    write_map(user.folder, theta_deg={"column": "a,deg", "unit": "deg"})
    said = user.types("import", "arm.csv", *IMPORT)
    assert said.code == 0, said.text
    found = imported(user.folder)
    assert found["theta_deg"] == pytest.approx(columns["angle"])
    assert found["p_exp_kpa"] == pytest.approx(columns["p"])
    assert said.left == IMPORTED
    files.add(
        'CSV header `t,"a,deg",p,z`', _IMPORTS, "columns of these names", said.code,
        "log and diagnosis",
    )  # fmt: skip


@pytest.mark.parametrize(("fault", "more"), [("more", ",7"), ("less", None)])
def test_row_of_other_length_than_the_header_is_refused(user, files, fault, more):
    def edit(lines):
        lines[16] = lines[16] + more if more else lines[16].rpartition(",")[0]

    write_csv(user.folder / "arm.csv", table(), edit=edit)
    write_map(user.folder)
    said = user.types("import", "arm.csv", *IMPORT)
    came = said.refuses(file="arm.csv", line=r"\b17\b")
    files.add(
        f"CSV row with one field {fault} than the header", _IMPORTS, came, said.code, "nothing"
    )


def test_text_that_matplotlib_takes_for_a_formula_is_drawn_as_it_is(user, files):
    columns = table()
    write_csv(user.folder / "arm.csv", columns, header="t,$\\frac{$,p,z")
    write_map(user.folder, theta_deg={"column": "$\\frac{$", "unit": "deg"})
    said = user.types("import", "arm.csv", *IMPORT)
    assert said.code == 0, said.text
    assert said.left == IMPORTED
    assert imported(user.folder)["theta_deg"] == pytest.approx(columns["angle"])
    files.add(
        "column named `$\\frac{$`", _IMPORTS, "the name, unchanged", said.code, "log and diagnosis"
    )


@pytest.mark.parametrize("wrong", [{"scale": 1e308}, {"offset": 1e308, "unit": "bar"}])
def test_scale_or_offset_beyond_all_numbers_is_refused(user, files, wrong):
    write_csv(user.folder / "arm.csv", table())
    write_map(user.folder, p_exp_kpa={"column": "p", "unit": "kPa"} | wrong)
    said = user.types("import", "arm.csv", *IMPORT)
    came = said.refuses(file="arm.csv|map.yaml", channel="p_exp_kpa")
    files.add("`scale` or `offset` of 1e308 in the map", _IMPORTS, came, said.code, "nothing")


@pytest.mark.parametrize("place", ["header", "field"])
def test_commands_to_the_terminal_are_not_printed(user, files, place):
    def edit(lines):
        if place == "field":
            lines[5] = lines[5].rpartition(",")[0] + ",\x1b[2J\x1b]0;mine\x07"

    header = "t,angle,p,\x1b[31mz\x9b2J" if place == "header" else None
    write_csv(user.folder / "arm.csv", table(), header=header, edit=edit)
    said = user.types("import", "arm.csv", "--list")
    assert said.code == 0, said.text
    files.add(
        "terminal control codes (ANSI) in a CSV file", _LISTS, "escaped", said.code,
        nothing_or(said.left),
    )  # fmt: skip


@pytest.fixture
def promise(user):
    """HDF5 file that declares 1e9 samples and has none."""

    def promise(name, units=False):
        with h5py.File(user.folder / name, "w") as file:
            for column in ("t", "angle", "p"):
                file.create_dataset(column, (10**9,), "f8", chunks=(2**18,), compression="gzip")

    return promise


@pytest.mark.slow
@pytest.mark.parametrize("command", [_LISTS, _IMPORTS])
def test_file_that_declares_more_than_it_can_hold_is_refused(user, files, promise, command):
    promise("arm.h5")
    write_map(user.folder)
    said = user.starts("import", "arm.h5", *(("--list",) if command == _LISTS else IMPORT))
    if command == _LISTS and said.code == 0:  # it may list what cannot be used, with the reason
        assert re.search(r"arm\.h5.*\bangle: cannot be a channel", said.text, re.DOTALL)
        came = "listed as unusable"
    else:
        came = said.refuses(file="arm.h5")
    files.add("HDF5 file that declares 1e9 samples", command, came, said.code, "nothing")


@pytest.mark.slow
@pytest.mark.parametrize(("jump_s", "at"), [(1e6, 150), (1e6, 299), (1e9, 150)])
def test_stamp_that_jumps_is_named(user, files, jump_s, at):
    columns = table()
    columns["t"][at:] += jump_s
    write_csv(user.folder / "arm.csv", columns)
    write_map(user.folder)
    said = user.starts("import", "arm.csv", *IMPORT)
    came = said.refuses(file="arm.csv", sample=rf"\b{at}\b")
    files.add(f"time stamps off by {jump_s:.0e} s", _IMPORTS, came, said.code, "nothing")


@pytest.mark.slow
def test_clock_in_another_unit_than_the_map_says_is_refused(user, files):
    columns = table(rows=24_000)
    columns["t"] *= 1e9
    write_csv(user.folder / "arm.csv", columns)
    write_map(user.folder, time={"column": "t", "unit": "us"})
    said = user.starts("import", "arm.csv", *IMPORT)
    came = said.refuses(file="arm.csv|map.yaml", column="time")
    files.add("two minutes in ns, and `us` in the map", _IMPORTS, came, said.code, "nothing")


@pytest.mark.slow
def test_hundred_thousand_columns_are_listed(user, files):
    path = user.folder / "wide.csv"
    names = ",".join(f"c{k}" for k in range(100_000))
    path.write_text("\n".join([names, *[",".join(["0"] * 100_000)] * 3]) + "\n")
    said = user.starts("import", "wide.csv", "--list")
    assert said.code == 0, said.text
    assert "c99999" in said.text
    files.add("CSV file of 100,000 columns", _LISTS, "all columns listed", said.code, "nothing")


def test_empty_variable_leaves_the_others(user, files):
    columns = table()
    with h5py.File(user.folder / "arm.mat", "w", userblock_size=512) as file:
        for name in ("t", "angle", "p"):
            file[name] = columns[name][None, :]
        file["empty"] = h5py.Empty("f8")
    with (user.folder / "arm.mat").open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    write_map(user.folder)
    said = user.types("import", "arm.mat", *IMPORT)
    assert said.code == 0, said.text
    assert imported(user.folder)["p_exp_kpa"] == pytest.approx(columns["p"])
    files.add(
        "an empty variable in a MATLAB 7.3 file", _IMPORTS, "the other variables", said.code,
        "log and diagnosis",
    )  # fmt: skip


def test_fields_of_cell_arrays_are_listed_as_the_map_wants_them(user, files):
    columns = table()
    cells = np.empty(2, object)
    cells[:] = [{"y": columns["p"], "u": columns["angle"]}, {"y": columns["z"], "u": columns["z"]}]
    scipy.io.savemat(user.folder / "arm.mat", {"train": cells, "t": columns["t"]})
    said = user.types("import", "arm.mat", "--list")
    assert said.code == 0, said.text
    listed = [line.split("  ")[0] for line in said.text.replace("\n  ", "\n").splitlines()]
    mine = {key: [n for n in listed if n.startswith("train") and n.endswith(key)] for key in "yu"}
    assert all(mine.values()), said.text
    write_map(
        user.folder,
        theta_deg={"column": mine["u"][0], "unit": "deg"},
        p_exp_kpa={"column": mine["y"][0], "unit": "kPa"},
    )
    done = user.types("import", "arm.mat", *IMPORT)
    assert done.code == 0, done.text
    assert imported(user.folder)["p_exp_kpa"] == pytest.approx(columns["p"])
    files.add(
        "MATLAB cell array of structs", f"{_LISTS}, then --map",
        "their fields, by the listed names", done.code, "log and diagnosis",
    )  # fmt: skip


def repeated():
    columns = table()
    columns["t"][41:44] = columns["t"][40]
    columns["t"][100] = columns["t"][99]
    return columns


def test_repeated_stamps_are_refused_with_the_way_on(user, files):
    write_csv(user.folder / "arm.csv", repeated())
    write_map(user.folder)
    said = user.types("import", "arm.csv", *IMPORT)
    came = said.refuses(file="arm.csv", sample=r"\b41\b", setting="repeated")
    files.add("repeated time stamps", _IMPORTS, came, said.code, "nothing")


@pytest.mark.parametrize("how", ["first", "mean"])
def test_repeated_stamps_become_one_sample_if_the_map_says_how(user, files, how):
    columns = repeated()
    write_csv(user.folder / "arm.csv", columns)
    write_map(user.folder, time={"column": "t", "repeated": how})
    said = user.types("import", "arm.csv", *IMPORT)
    assert said.code == 0, said.text
    found = imported(user.folder)
    at = np.searchsorted(found["time_s"], columns["t"][40] - 1e-9)
    group = columns["p"][40:44]
    assert found["p_exp_kpa"][at] == pytest.approx(group[0] if how == "first" else group.mean())
    words = json.loads((user.folder / "out.diagnosis.json").read_text())["words"]
    assert any(re.search(r"\b4\b.*(stamp|instant|repeat)", line) for line in words), words
    files.add(
        f"repeated time stamps, `time.repeated: {how}`", _IMPORTS,
        "one sample per time stamp, with a note", said.code, "log and diagnosis",
    )  # fmt: skip


def test_all_problems_of_a_map_are_reported_together(user, files):
    write_csv(user.folder / "arm.csv", table())
    write_map(
        user.folder,
        theta_deg={"column": "anglle", "unit": "deg"},
        p_exp_kpa={"column": "p", "unit": "baar"},
    )
    said = user.types("import", "arm.csv", *IMPORT)
    came = said.refuses(
        unit="baar", column="anglle", **{"the nearest unit": r"did you mean \W*bar\b"},
        **{"the nearest column": r"did you mean \W*angle\b"},
    )  # fmt: skip
    files.add("a wrong unit and a wrong column in one map", _IMPORTS, came, said.code, "nothing")


def as_text(columns, separator=";", decimal=","):
    """Return the lines of a recording with a decimal comma."""
    rows = zip(*columns.values(), strict=True)
    return [separator.join(columns), *(
        separator.join(f"{x:.3f}".replace(".", decimal) for x in row) for row in rows
    )]  # fmt: skip


def test_column_with_another_decimal_mark_is_refused(user, files):
    lines = as_text(table())
    lines[1:] = [line.rpartition(";")[0] + f";50.{k:03}" for k, line in enumerate(lines[1:])]
    (user.folder / "arm.csv").write_text("\n".join(lines) + "\n")
    write_map(user.folder, p_exp_kpa={"column": "z", "unit": "Pa"})
    said = user.types("import", "arm.csv", *IMPORT)
    came = said.refuses(
        file="arm.csv", line="line 2", **{"both columns": "column (t|angle)"},
        **{"both readings": "50 with a decimal point or 50000"},
    )  # fmt: skip
    files.add(
        "a column `50.000` in a CSV file with decimal commas", _IMPORTS, came, said.code, "nothing"
    )


def test_line_without_its_end_is_left_out(user, files):
    columns = table()
    write_csv(user.folder / "arm.csv", columns)
    path = user.folder / "arm.csv"
    path.write_bytes(path.read_bytes()[:-2])
    write_map(user.folder)
    said = user.types("import", "arm.csv", *IMPORT)
    assert said.code == 0, said.text
    assert "line 301, the last, has no line end" in said.text
    assert imported(user.folder)["p_exp_kpa"] == pytest.approx(columns["p"][:-1])
    files.add(
        "CSV file cut in its last number", _IMPORTS, "all lines but the last, with a note",
        said.code, "log and diagnosis",
    )  # fmt: skip


def test_number_that_is_too_small_is_refused(user, files):
    def edit(lines):
        t, _, *rest = lines[16].split(",")
        lines[16] = ",".join([t, "1e-400", *rest])

    write_csv(user.folder / "arm.csv", table(), edit=edit)
    write_map(user.folder)
    said = user.types("import", "arm.csv", *IMPORT)
    came = said.refuses(file="arm.csv", line=r"\b17\b", value="1e-400")
    files.add("`1e-400` in a CSV file", _IMPORTS, came, said.code, "nothing")


def test_chunk_that_was_never_written_is_refused(user, files):
    with h5py.File(user.folder / "arm.h5", "w") as file:
        for name, values in table().items():
            dataset = file.create_dataset(name, values.shape, "f8", chunks=(50,))
            dataset[: 200 if name == "p" else 300] = values[: 200 if name == "p" else 300]
    write_map(user.folder)
    said = user.types("import", "arm.h5", *IMPORT)
    came = said.refuses(file="arm.h5", dataset=r"\bp\b", chunk=r"\[200\]")
    files.add("HDF5 file with a chunk never written", _IMPORTS, came, said.code, "nothing")


@pytest.mark.parametrize("name", ["out.diagnosis.json", "out.diagnosis.png"])
@pytest.mark.parametrize("folder", [False, True])
def test_file_beside_the_log_that_is_not_ours_is_kept(user, files, name, folder):
    write_csv(user.folder / "arm.csv", table())
    write_map(user.folder)
    if folder:
        (user.folder / name).mkdir()
    else:
        (user.folder / name).write_text("mine")
    said = user.types("import", "arm.csv", *IMPORT)
    came = said.refuses(file=name)
    assert folder or (user.folder / name).read_text() == "mine"
    what = "a folder" if folder else "a file of something else"
    files.add(f"{what} with the name of the diagnosis or its picture", _IMPORTS, came, said.code,
              "nothing")  # fmt: skip


# --- what is no file, and what cannot be written --------------------------------------------

READING = {
    "fprc config check": "config check X.yaml",
    "fprc simulate --config": "simulate sweep --config X.yaml --out out.h5",
    "fprc simulate --rig": "simulate sweep --rig X.yaml --out out.h5",
    "fprc calibrate --published": "calibrate --published X.yaml --out out.yaml",
    "fprc rig run --config": "rig run sweep --config X.yaml",
    "fprc train": "train X.h5 --out out.h5",
    "fprc predict": "predict X.h5 X.h5 --out out.csv",
    "fprc export": "export X.h5 --c out.h",
    "fprc import --list": "import X.csv --list",
    "fprc import --list, HDF5": "import X.h5 --list",
    "fprc import --list, MATLAB": "import X.mat --list",
    "fprc import --map": "import arm.csv --map X.yaml --out out.h5",
    "fprc readout": "readout X.csv --map two.yaml --out out",
    "fprc log check": "log check X.h5",
    "fprc log repair": "log repair X.journal --out out.h5",
}
WRITING = {
    "fprc simulate --out": "simulate sweep --config none.yaml --out X.h5",
    "fprc train --out": "train none.h5 --out X.h5",
    "fprc predict --out": "predict none.h5 none.h5 --out X.h5",
    "fprc export --c": "export none.h5 --c X.h",
    "fprc import --out": "import none.csv --map map.yaml --out X.h5",
    "fprc log repair --out": "log repair none.h5 --out X.h5",
    "fprc rig run --out": "rig run sweep --out X.h5",
    "fprc calibrate --out": "calibrate --published none.yaml --out X.yaml",
    "fprc readout --out": "readout none.csv --map two.yaml --out X",
}


def make(kind, name):
    if kind == "a pipe":
        os.mkfifo(name)
    elif kind == "a folder":
        os.mkdir(name)
    else:
        os.symlink({"a link to /dev/zero": "/dev/zero", "a link to itself": name}[kind], name)


@pytest.fixture
def maps(user):
    """Maps for `fprc import` and `fprc readout`."""
    write_map(user.folder, p_o_kpa={"column": "z", "unit": "kPa"})
    told = yaml.safe_load((user.folder / "map.yaml").read_text())
    del told["experiment"]
    (user.folder / "two.yaml").write_text(yaml.safe_dump(told | {"test_from_s": 1}))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["a pipe", "a link to /dev/zero", "a link to itself", "a folder"])
@pytest.mark.parametrize("command", READING)
def test_what_is_no_file_is_refused_at_once(user, files, maps, command, kind):
    for suffix in ("yaml", "csv", "mat", "h5", "journal"):
        make(kind, f"what.{suffix}")
    said = user.types(*READING[command].replace("X", "what").split())
    came = said.refuses(file=r"what\.\w+: cannot be opened")
    files.add(
        "a pipe, a link to `/dev/zero` or to itself, or a folder in place of a file",
        "every command that reads files", came, said.code, "nothing",
    )  # fmt: skip


OUTPUTS = [
    (command, name)
    for command in WRITING
    for name in ("x" * 300, "x" * 250, "map.yaml/out", "/proc/none/out", "folder", "other")
    if command != "fprc readout --out" or name not in ("x" * 250, "folder", "other")
]


@pytest.mark.parametrize(("command", "name"), [*OUTPUTS, ("fprc readout --out", "map.yaml")])
def test_output_that_cannot_be_written_is_refused_before_any_file_is_read(
    user, files, maps, command, name
):
    words = WRITING[command].replace("X", name)
    if name == "other":
        words = words.rpartition(".")[0] + ".hdf5"
    for suffix in (".h5", ".h", ".yaml"):
        (user.folder / f"folder{suffix}").mkdir()
    said = user.types(*words.split())
    came = said.refuses(output=re.escape(words.split()[-1][:40]))
    files.add(
        "output with another ending, a name of 250 or 300 bytes, of a folder, in a file, in /proc",
        "every command that writes files", came, said.code, "nothing",
    )  # fmt: skip


# --- raw logs -------------------------------------------------------------------------------


@pytest.fixture
def write_log(user, signals):
    """Write a raw log, with given channels and attributes instead of the usual ones."""

    def write(name="log.h5", changed=None, track=False, **more):
        channels = signals.tracking() if track else signals.hysteresis()
        for channel, (sample, value) in (changed or {}).items():
            channels[channel][sample] = value
        attributes = {
            "experiment": "sweep", "source": "sim", "sample_rate_hz": RATE_HZ, "seed": 1,
            "software": "fprc test", "rig": {},
        }  # fmt: skip
        if track:
            attributes |= {
                "experiment": "track_sine_0p2_fprc_pd", "reference": "sine_0p2",
                "controller": "fprc_pd", "settle_s": 0.5,
            }  # fmt: skip
        write_raw(user.folder / name, channels, **attributes | more)
        return user.folder / name

    return write


@pytest.mark.parametrize(
    "attributes",
    [{}, {"track": True},
     {"track": True, "experiment": "track_sine_0p2_fprc_pd_printed", "gain": "printed"}],
    ids=["experiment", "run", "run of an earlier version"],
)  # fmt: skip
def test_good_log_passes(user, write_log, attributes):
    write_log(**attributes)
    said = user.types("log", "check", "log.h5")
    assert said.code == 0, said.text
    assert not said.left


@pytest.mark.parametrize(
    ("channel", "value", "track"),
    [
        ("p_exp_command_kpa", 1e6, False),
        ("valve_main_v", 50.0, False),
        ("valve_reservoir_v", -50.0, False),
        ("phi_deg", 5e3, False),
        ("p_ff_kpa", 1e6, True),
        ("theta_d_deg", 5e3, True),
    ],
)
def test_channel_that_leaves_its_range_is_reported(user, files, write_log, channel, value, track):
    write_log(changed={channel: (123, value)}, track=track)
    said = user.types("log", "check", "log.h5")
    came = said.refuses(file="log.h5", channel=channel)
    files.add(f"`{channel}` of {value:g} in a log", "fprc log check", came, said.code, "nothing")


def test_closed_loop_log_without_a_channel_is_refused(user, files, write_log):
    with h5py.File(write_log(track=True), "a") as log:
        del log["p_ff_kpa"]
    said = user.types("log", "check", "log.h5")
    came = said.refuses(file="log.h5", channel="p_ff_kpa")
    files.add("closed-loop log without `p_ff_kpa`", "fprc log check", came, said.code, "nothing")


def test_closed_loop_log_without_a_number_is_refused(user, files, write_log):
    with h5py.File(write_log(track=True), "a") as log:
        log["theta_d_deg"][77] = np.nan
    said = user.types("log", "check", "log.h5")
    came = said.refuses(file="log.h5", channel="theta_d_deg")
    files.add("NaN in `theta_d_deg`", "fprc log check", came, said.code, "nothing")


@pytest.mark.slow
def test_flipped_byte_of_a_channel_has_a_name(user, files, write_log):
    path = write_log(track=True)
    data = path.read_bytes()
    with h5py.File(path) as log:
        places = {name: stored(log[name]) for name in log}
    rng = np.random.default_rng(16)
    names = {channel: f"{number}.h5" for number, channel in enumerate(places)}
    for channel, (begin, size) in places.items():
        flipped = bytearray(data)
        flipped[begin + int(rng.integers(size))] ^= 1 << int(rng.integers(8))
        (user.folder / names[channel]).write_bytes(flipped)
    said = user.types("log", "check", *names.values())
    for channel, name in names.items():
        came = said.refuses(file=name, channel=f"\\b{name}: .*{channel}")
    files.add(
        f"one bit of a channel flipped, in each of {len(places)} channels", "fprc log check", came,
        said.code, "nothing",
    )  # fmt: skip


def stored(dataset):
    """Return the offset of a dataset in its file, and its length in bytes."""
    if dataset.chunks is None:
        return dataset.id.get_offset(), dataset.id.get_storage_size()
    chunk = dataset.id.get_chunk_info(0)
    return chunk.byte_offset, chunk.size


def elsewhere(log, way):
    values = log["p_o_kpa"][:]
    del log["p_o_kpa"]
    if way == "external link":
        with h5py.File("other.h5", "w") as other:
            other["p_o_kpa"] = values
            other["p_o_kpa"].attrs["units"] = "kPa"
        log["p_o_kpa"] = h5py.ExternalLink("other.h5", "/p_o_kpa")
        return
    Path("other.raw").write_bytes(values.tobytes())
    dataset = log.create_dataset(
        "p_o_kpa", values.shape, "f8", external=[("other.raw", 0, values.nbytes)]
    )
    dataset.attrs["units"] = "kPa"


@pytest.mark.parametrize("way", ["external link", "external storage"])
def test_numbers_of_another_file_are_refused(user, files, write_log, way):
    with h5py.File(write_log(), "a") as log:
        elsewhere(log, way)
    said = user.types("log", "check", "log.h5")
    came = said.refuses(file="log.h5", channel="p_o_kpa")
    files.add(f"{way} in place of a channel", "fprc log check", came, said.code, "nothing")


@pytest.mark.slow
def test_log_that_declares_more_than_it_can_hold_is_refused(user, files, write_log):
    with h5py.File(write_log(), "a") as log:
        for name in list(log):
            units = log[name].attrs["units"]
            del log[name]
            dataset = log.create_dataset(name, (10**9,), "f8", chunks=(2**18,), compression="gzip")
            dataset.attrs["units"] = units
    said = user.starts("log", "check", "log.h5")
    came = said.refuses(file="log.h5")
    files.add("log that declares 1e9 samples", "fprc log check", came, said.code, "nothing")


def plain_log(path, signals):
    """Write a log without checksums, as other programs do."""
    with h5py.File(path, "w") as log:
        log.attrs.update(
            experiment="sweep", source="rig", simulated=False, sample_rate_hz=RATE_HZ, seed=1,
            software="mine", rig="{}",
        )  # fmt: skip
        for name, values in signals.hysteresis().items():
            unit = {"s": "s", "v": "V", "kpa": "kPa", "deg": "deg"}[name.rpartition("_")[2]]
            log[name] = values
            log[name].attrs["units"] = unit


def endless(data):
    """Give a text in the heap a length that makes the library loop endlessly."""
    at = data.index(b"GCOL") + 16
    *_, last = texts(data, at)
    data[last + 8] ^= 0x72


def texts(data, at):
    """Yield the offset of each text in the heap."""
    while True:
        (number,) = struct.unpack_from("<H", data, at)
        if number == 0:
            return
        yield at
        (size,) = struct.unpack_from("<Q", data, at + 8)
        at += 16 + -(-size // 8) * 8


def crashing(data):
    """Declare a text a list, so that the library reads an invalid address."""
    at = data.index(b"\x19\x01\x01\x00", data.index(b"experiment\x00"))
    data[at + 1] ^= 0x7D


@pytest.mark.slow
@pytest.mark.parametrize(
    ("spoil", "what"), [(endless, "hangs"), (crashing, "crashes")], ids=["hangs", "crashes"]
)
def test_byte_that_hangs_or_crashes_the_library_is_a_message(user, files, signals, spoil, what):
    path = user.folder / "log.h5"
    plain_log(path, signals)
    data = bytearray(path.read_bytes())
    spoil(data)
    path.write_bytes(data)
    said = user.starts("log", "check", "log.h5")
    came = said.refuses(file="log.h5")
    files.add(
        f"metadata byte that {what} the HDF5 library", "fprc log check", came, said.code, "nothing"
    )


@pytest.mark.parametrize("writer", ["fprc", "another program"])
def test_bad_byte_in_an_attribute_is_refused(user, files, write_log, signals, writer):
    path = user.folder / "log.h5"
    if writer == "fprc":
        write_log(software="mine")
    else:
        plain_log(path, signals)
    data = path.read_bytes()
    assert data.count(b"mine") == 1
    path.write_bytes(data.replace(b"mine", b"\xffine"))
    said = user.types("log", "check", "log.h5")
    came = said.refuses(file="log.h5")
    files.add(
        f"a bad byte in an attribute of a log of {writer}", "fprc log check", came, said.code,
        "nothing",
    )  # fmt: skip


def test_damaged_log_is_not_repaired_but_its_journal_named(user, files, write_log):
    write_log()
    said = user.types("log", "repair", "log.h5", "--out", "copy.h5")
    came = said.refuses(file="log.h5", **{"the journal": r"log\.\*\.journal"})
    files.add("a raw log in place of a journal", "fprc log repair", came, said.code, "nothing")


@pytest.mark.parametrize(
    ("name", "value"),
    [("notes", "{"), ("statistics", 5), ("sample_rate_hz", np.inf), ("rig", "{")],
)
def test_attribute_that_is_not_right_is_named(user, files, write_log, name, value):
    with h5py.File(write_log(), "a") as log:
        log.attrs[name] = value
    said = user.types("log", "check", "log.h5")
    came = said.refuses(file="log.h5", attribute=name)
    files.add(f"attribute `{name} = {value}`", "fprc log check", came, said.code, "nothing")


@pytest.mark.parametrize("channel", ["p_i_kpa", "p_o_kpa"])
def test_huge_numbers_are_no_reason_to_fall_over(user, files, write_log, channel):
    write_log(changed={channel: (slice(None, None, 2), 1e200)})
    said = user.types("log", "check", "log.h5")
    came = said.refuses(file="log.h5", channel=channel)
    files.add("1e200 in a channel of the leak test", "fprc log check", came, said.code, "nothing")


# --- configurations -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "key", "what"),
    [
        ("seed: 2\nseed: 3\n", "seed", "`seed` twice"),
        ("models: {n_y: 3}\nseed: 2\nmodels: {alpha: 0.1}\n", "models", "`models` twice"),
        ("models:\n  fprc: {n_c: 4, n_c: 5}\n", "n_c", "a key twice in a section"),
    ],
)
def test_key_that_is_there_twice_is_refused(user, files, text, key, what):
    (user.folder / "mine.yaml").write_text(text)
    said = user.types("config", "check", "mine.yaml")
    came = said.refuses(file="mine.yaml", key=rf"\b{key}\b")
    files.add(f"{what} in a configuration", "fprc config check", came, said.code, "nothing")


def test_number_with_a_zero_before_it_is_decimal(user, files):
    (user.folder / "mine.yaml").write_text("seed: 010\n")
    said = user.types("config", "check", "mine.yaml")
    assert said.code == 0, said.text
    assert from_files(["mine.yaml"]).seed == 10
    files.add("`seed: 010`", "fprc config check", "10", said.code, "nothing")


def test_number_with_a_colon_is_none(user, files):
    (user.folder / "mine.yaml").write_text("experiments: {sweep: {duration_s: 1:30}}\n")
    said = user.types("config", "check", "mine.yaml")
    came = said.refuses(key=r"sweep\.duration_s", value="1:30")
    files.add("`duration_s: 1:30`", "fprc config check", came, said.code, "nothing")


@pytest.mark.parametrize(
    "folders",
    [
        *[{"results": name} for name in ("/", "src", "src/", ".git", "config")],
        *[{"raw": name} for name in ("src/mine", "./config", "a\0b", "a{b}", "a\nb", "x" * 300)],
        {"raw": "mine", "results": "mine"},
        {"raw": "mine", "results": "./mine/"},
    ],
    ids=lambda folders: "_".join(folders.values())[:12].encode("unicode_escape").decode(),
)
def test_folder_that_results_must_not_go_to_is_refused(user, files, folders):
    for name in ("src", ".git", "config"):
        (user.folder / name).mkdir()
    (user.folder / "mine.yaml").write_text(json.dumps({"folders": folders}))
    said = user.types("config", "check", "mine.yaml")
    came = said.refuses(key="folders")
    files.add(
        "folders.raw or folders.results: `/`, `src`, `.git`, `config` or in them, both the same, a "
        "NUL, a brace, a newline, 300 characters",
        "fprc config check", came, said.code, "nothing",
    )  # fmt: skip


# --- the workflow ---------------------------------------------------------------------------


@pytest.fixture
def plan(user, tmp_path):
    """Plan the workflow, in a copy of the project."""
    project = tmp_path / "project"
    project.mkdir()
    for name in ("config", "workflow"):
        shutil.copytree(ROOT / name, project / name)

    def plan(*more):
        program = [sys.executable, "-m", "snakemake", "-n", "--cores", "1"]
        return user.starts(*more, program=program, folder=project)

    return plan


@pytest.mark.slow
def test_key_that_is_there_twice_is_refused_by_the_workflow(user, files, plan):
    (user.folder / "mine.yaml").write_text("seed: 2\nseed: 3\n")
    said = plan("--configfile", str(user.folder / "mine.yaml"))
    came = said.refuses(file="mine.yaml", key=r"\bseed\b")
    files.add("`seed` twice in a configuration", "snakemake -n", came, said.code, "nothing")


@pytest.mark.slow
def test_number_with_a_zero_before_it_is_decimal_in_the_workflow(user, files, plan):
    # 8, as YAML 1.1 reads it, would be a further seed that is not a further one
    (user.folder / "mine.yaml").write_text("seed: 010\nevaluation: {replicate_seeds: [8, 301]}\n")
    said = plan("table2", "--configfile", str(user.folder / "mine.yaml"))
    assert said.code == 0, said.text
    files.add("`seed: 010`", "snakemake -n", "10", said.code, "nothing")


@pytest.mark.slow
def test_byte_that_hangs_the_library_is_a_message_of_the_workflow(user, files, signals, plan):
    raw = user.folder / "raw"
    raw.mkdir()
    (raw / "complex.h5").write_bytes(b"no log")
    plain_log(raw / "sweep.h5", signals)
    data = bytearray((raw / "sweep.h5").read_bytes())
    endless(data)
    (raw / "sweep.h5").write_bytes(data)
    folders = f"folders={{raw: {raw}, results: {user.folder / 'results'}}}"
    said = plan("table2", "--config", "source=recorded", folders)
    came = said.refuses(file=r"sweep\.h5: not read within")
    assert "complex.h5: not an HDF5 file" in said.text
    files.add(
        "metadata byte that hangs the HDF5 library", "snakemake -n", came, said.code, "nothing"
    )
