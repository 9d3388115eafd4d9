"""Recordings as programs of the field write them: sixty samples of the same motion each."""

import json
from collections.abc import Callable
from datetime import datetime, timedelta
from typing import Any, NamedTuple

import h5py
import numpy as np
import pandas as pd
import scipy.io

COUNT, RATE_HZ = 60, 100.0
T = np.arange(COUNT) / RATE_HZ
ANGLE = np.round(30.0 - 30.0 * np.cos(7.0 * T), 4)
PRESSURE = np.round(120.0 - 100.0 * np.cos(7.0 * T - 0.4), 4)
P_O = np.round(35.0 + 15.0 * np.sin(7.0 * T), 4)
NAMES = ["time_s", "angle_deg", "pressure_kPa", "p_o_kPa"]
BARE = ["time", "angle", "pressure", "p_o"]
#: Channel by its place among the columns.
CHANNELS = ("theta_deg", "p_exp_kpa", "p_o_kpa")
START = datetime(2024, 3, 8, 21, 10, 0, 5000)


class Case(NamedTuple):
    """A file, and what its draft must lead to."""

    file: str
    content: str | bytes | Callable[[Any], None]
    rate_hz: float = RATE_HZ
    time_s: np.ndarray = T  #: of the samples that are kept
    edits: dict[str, Any] = {}  #: what a person must write into the draft
    kept: np.ndarray = np.arange(COUNT)
    doubt: str = ""  #: what a line of the draft must say


def rows(*columns, separator=",", decimal="."):
    """Return the lines of columns, of numbers or texts."""
    texts = [
        [v if isinstance(v, str) else f"{v:.10g}".replace(".", decimal) for v in column]
        for column in columns
    ]
    return ["".join([separator.join(row), "\n"]) for row in zip(*texts, strict=True)]


def text(names=NAMES, time=T, *, more=(), top="", separator=",", decimal=".", values=None):
    """Return a text table of the motion; ``more`` are columns behind the clock."""
    columns = [ANGLE, PRESSURE, P_O] if values is None else values
    lines = rows(time, *more, *columns, separator=separator, decimal=decimal)
    header = separator.join(names) + "\n" if names else ""
    return top + header + "".join(lines)


def lines_with(place, line):
    """Return the plain table with a line inserted before a sample, or with one replaced."""
    lines = text().splitlines(keepends=True)
    return "".join([*lines[: place + 1], line, *lines[place + 1 :]])


def stamps(form, step_s=0.01):
    """Return dates of the samples; %f3 is milliseconds."""
    dates = [START + timedelta(seconds=step_s * k) for k in range(COUNT)]
    return [date.strftime(form.replace("%f3", f"{date.microsecond // 1000:03}")) for date in dates]


def matlab(**content):
    return lambda path: scipy.io.savemat(path, content)


def structs(**fields):
    """Return a struct array of MATLAB from the values of each field."""
    made = np.empty((1, len(next(iter(fields.values())))), [(name, object) for name in fields])
    for name, values in fields.items():
        for k, value in enumerate(values):
            made[0, k][name] = value
    return made


def hdf5(write):
    def written(path):
        with h5py.File(path, "w") as file:
            write(file)

    return written


def _columns(values):
    return [column.reshape(-1, 1) for column in values]


def _with_units(file, unit="units", of=("ms", "rad", "bar", "bar")):
    values = (1e3 * T, np.deg2rad(ANGLE), PRESSURE / 100.0, P_O / 100.0)
    for name, column, what in zip(BARE, values, of, strict=True):
        file[name] = column
        file[name].attrs[unit] = what


def _compound(file):
    table = np.rec.fromarrays([T, ANGLE, PRESSURE, P_O], names=NAMES)
    file.create_dataset("run/table", data=table)


def _groups(file):
    for name, values in zip(BARE[1:], (ANGLE, PRESSURE, P_O), strict=True):
        file[f"{name}/time"], file[f"{name}/value"] = T, values
        file[f"{name}/value"].attrs["units"] = "deg" if name == "angle" else "kPa"


def _lvm(mark, x_columns, body, units="deg\tkPa\tkPa", channels=3, delta="0.01"):
    zero = f"0{mark}0"
    labels = {"No": "X_Value\tangle\tpressure\tp_o", "One": "X_Value\tangle 1\tpressure 1\tp_o",
              "Multi": "X_Value\tangle\tX_Value\tpressure\tX_Value\tp_o"}  # fmt: skip
    return (
        "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\n"
        f"Decimal_Separator\t{mark}\nMulti_Headings\tNo\nX_Columns\t{x_columns}\n"
        "Time_Pref\tRelative\n***End_of_Header***\t\n\t\n"
        f"Channels\t{channels}\t\t\t\nSamples\t60\t60\t60\t\nY_Unit_Label\t{units}\t\n"
        f"X_Dimension\tTime\tTime\tTime\t\nX0\t{zero}\t{zero}\t{zero}\t\n"
        f"Delta_X\t{(delta + chr(9)) * 3}\n***End_of_Header***\t\t\t\t\n"
        f"{labels[x_columns]}\tComment\n{body}"
    )


def _pairs(separator="\t"):
    """Return the body of a table in which the pressures have half the rate of the angle."""
    short = [*range(0, COUNT, 2)]
    lines = []
    for k in range(COUNT):
        row = [f"{10 * k}", f"{ANGLE[k]:g}"]
        for values in (PRESSURE, P_O):
            row += [f"{10 * short[k]}", f"{values[short[k]]:g}"] if k < len(short) else [" ", " "]
        lines.append(separator.join(row) + "\n")
    return "".join(lines)


_TWINCAT = (
    "Name\tScope 1\nStarttime of export\t132959733843760000\tMonday\t15:56:24.376\n\n\n"
    "Name\tangle\tName\tpressure\tName\tp_o\n"
    "Data-Type\tREAL64\tData-Type\tREAL64\tData-Type\tREAL64\n"
    "SampleTime[ms]\t10\tSampleTime[ms]\t20\tSampleTime[ms]\t20\n"
    "Unit\tdeg\tUnit\tkPa\tUnit\tkPa\n\n"
)


def _excel(title):
    def write(path):
        dates = pd.Series(pd.to_datetime(stamps("%Y-%m-%d %H:%M:%S.%f")))
        frame = pd.DataFrame({"Zeit": dates, "Winkel [°]": ANGLE, "Druck [bar]": PRESSURE / 100.0,
                              "Kammerdruck [bar]": P_O / 100.0})  # fmt: skip
        with pd.ExcelWriter(path, engine="openpyxl") as writer:
            pd.DataFrame({"note": ["made by hand"]}).to_excel(writer, sheet_name="Info")
            frame.to_excel(writer, sheet_name="Daten", index=False, startrow=2 * bool(title))
            if title:
                writer.sheets["Daten"]["A1"] = title

    return write


def _tdms(path):
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(path) as writer:
        for name, values, unit in (("angle", ANGLE, "deg"), ("pressure", PRESSURE, "kPa"),
                                   ("p_o", P_O, "kPa")):  # fmt: skip
            properties = {"wf_increment": 0.01, "wf_start_offset": 0.0, "unit_string": unit}
            writer.write_segment([ChannelObject("run", name, values, properties)])


def _parquet(path):
    stamped = pd.to_datetime(stamps("%Y-%m-%d %H:%M:%S.%f"))
    table = pd.DataFrame({"timestamp": stamped, "angle_deg": ANGLE, "pressure_kPa": PRESSURE})
    table.assign(p_o_kPa=P_O).to_parquet(path)


def _mcap(path):
    from mcap.writer import Writer

    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("arm", "jsonschema", b'{"type": "object"}')
        channel = writer.register_channel("/arm", "json", schema)
        for k in range(COUNT):
            ns = 1_700_000_000_000_000_000 + 10_000_000 * k
            values = dict(zip(NAMES[1:], (ANGLE[k], PRESSURE[k], P_O[k]), strict=True))
            writer.add_message(channel, ns, json.dumps(values).encode(), ns)
        writer.finish()


def _bag(path):
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    kind = store.types["std_msgs/msg/Float64"]
    with Writer(path) as writer:
        for topic, values in (
            ("/angle_deg", ANGLE),
            ("/pressure_kPa", PRESSURE),
            ("/p_o_kPa", P_O),
        ):
            link = writer.add_connection(topic, kind.__msgtype__, typestore=store)
            for k, value in enumerate(values):
                ns = 1_700_000_000_000_000_000 + 10_000_000 * k
                raw = store.serialize_ros1(kind(float(value)), kind.__msgtype__)
                writer.write(link, ns, raw)


def _npy(path):
    np.save(path, np.rec.fromarrays([T, ANGLE, PRESSURE, P_O], names=NAMES))


def _npz(path):
    np.savez(path, **dict(zip(NAMES, [T, ANGLE, PRESSURE, P_O], strict=True)))


RNG = np.random.default_rng(1)
JITTER = np.append(0.0, np.round(np.cumsum(RNG.exponential(0.01, COUNT - 1)), 6))
NORMAL = np.round(T + RNG.uniform(0.0, 0.004, COUNT), 6)
PAUSED = T + 5.0 * (T >= 0.3)
FRAMES = np.round(np.arange(COUNT) / 30.0, 3)
TICKS = np.round(np.arange(COUNT) * 1000.0 / 129.0)
EVEN = np.arange(0, COUNT, 2)
BY_NUMBER = {
    f"channels.{name}": {"column": str(k + 1), "unit": "deg" if k == 0 else "kPa"}
    for k, name in enumerate(CHANNELS)
}
SERIAL = stamps("%H:%M:%S.%f3 -> ")
IN_WORDS = [f"angle: {a:g} deg, pressure: {p:g} kPa, p_o: {o:g} kPa\n"
            for a, p, o in zip(ANGLE, PRESSURE, P_O, strict=True)]  # fmt: skip
FOUR = "Device: X\nDate: 2024-03-08\nRate: 100 Hz\n\n"


def _at(unit_s, start=0.0, rate_hz=RATE_HZ):
    return [f"{start + k / rate_hz / unit_s:.12g}" for k in range(COUNT)]


def _whole(unit_s, start, rate_hz=RATE_HZ):
    return [str(start + round(k / rate_hz / unit_s)) for k in range(COUNT)]


SLOW = np.arange(COUNT) / 10.0
#: Every kind of ../cases in the order of their numbers, and more; the names say what is odd.
CASES = {
    # slow clocks, and clocks that count from 1970 or 1900
    "t of 10 Hz": Case("a.csv", text(["t", *NAMES[1:]], SLOW), 10.0, SLOW, doubt="unit?"),
    "stamp of 9 Hz": Case(
        "a.csv", text(["stamp", *NAMES[1:]], [f"{1.7e9 + k / 9:.6f}" for k in range(COUNT)]), 9.0,
        np.arange(COUNT) / 9.0),
    "time of 2 Hz": Case("a.csv", text(["time", *NAMES[1:]], T * 50), 2.0, T * 50),
    "epoch in ms": Case("a.csv", text(["stamp", *NAMES[1:]], _whole(1e-3, 1700000000000))),
    "epoch in ns": Case("a.csv", text(["stamp", *NAMES[1:]], _whole(1e-9, 1700000000 * 10**9))),
    "days of Excel": Case(
        "a.csv", text(["Time", *NAMES[1:]], [f"{45359 + k / 8640000:.10f}" for k in range(COUNT)])),
    # counters
    "sample number": Case("a.csv", text(["Sample", *NAMES[1:]], np.arange(COUNT)),
                          edits={"time": {"rate_hz": 100}}, doubt="seems to count"),
    "number from 1": Case("a.csv", text(["#", *NAMES[1:]], np.arange(COUNT) + 1),
                          edits={"time": {"rate_hz": 100}}),
    "index and clock": Case("a.csv", text(["", *NAMES], np.arange(COUNT), more=[T])),
    # structs of MATLAB
    "structure with time": Case("a.mat", matlab(out={
        "time": T.reshape(-1, 1), "signals": structs(values=_columns([ANGLE, PRESSURE, P_O]),
                                                     label=BARE[1:], dimensions=[1, 1, 1]),
        "blockName": "model/To Workspace"})),
    "dSPACE": Case("a.mat", matlab(run={
        "X": structs(Name=["Time"], Data=[T], Unit=["s"]),
        "Y": structs(Name=["Model/angle", "Model/pressure", "Model/p_o"],
                     Data=[ANGLE, PRESSURE / 100.0, P_O / 100.0], Unit=["deg", "bar", "bar"])})),
    "struct array": Case("a.mat", matlab(run=structs(
        time=[T, T], angle=[ANGLE, ANGLE], pressure=[PRESSURE, PRESSURE], p_o=[P_O, P_O]))),
    "struct of series": Case("a.mat", matlab(out={
        name: {"Time": T, "Data": values}
        for name, values in zip(BARE[1:], (ANGLE, PRESSURE, P_O), strict=True)})),
    # dates
    "ISO, blank": Case("a.csv", text(["timestamp", *NAMES[1:]], stamps("%Y-%m-%d %H:%M:%S.%f3"))),
    "ISO, T and Z": Case("a.csv", text(["time", *NAMES[1:]], stamps("%Y-%m-%dT%H:%M:%S.%f3Z"))),
    "date and time": Case(
        "a.csv", text(["Date", "Time", *NAMES[1:]], stamps("%Y-%m-%d"),
                      more=[stamps("%H:%M:%S.%f3")])),
    "German date": Case("a.csv", text(
        ["Zeit", *NAMES[1:]], stamps("%d.%m.%Y %H:%M:%S,%f3"), separator=";", decimal=",")),
    "h:m:s": Case("a.csv", text(["t", *NAMES[1:]], stamps("%H:%M:%S.%f3"))),
    "AM and PM": Case("a.csv", text(["Time", *NAMES[1:]], stamps("%m/%d/%Y %I:%M:%S.%f3 %p"))),
    "secs and nsecs": Case("a.csv", text(
        ["header.stamp.secs", "header.stamp.nsecs", *NAMES[1:]],
        [str(1700000000 + (k + 50) // 100) for k in range(COUNT)],
        more=[[str(10**7 * ((k + 50) % 100)) for k in range(COUNT)]])),
    # LabVIEW
    "LVM, one X": Case("a.lvm", _lvm(".", "One", "".join(
        rows(T, ANGLE, PRESSURE, P_O, separator="\t")))),
    "LVM, comma, no X": Case("a.lvm", _lvm(",", "No", "".join(
        rows([""] * COUNT, ANGLE, PRESSURE, P_O, separator="\t", decimal=",")), delta="0,01")),
    "LVM, many X": Case("a.lvm", _lvm(".", "Multi", "".join(
        rows(T, ANGLE, T, PRESSURE, T, P_O, separator="\t")), units="deg\t\tkPa\t\tkPa")),
    "LVM, bar": Case("a.lvm", _lvm(".", "One", "".join(
        rows(T, ANGLE, PRESSURE / 100.0, P_O / 100.0, separator="\t")), units="deg\tbar\tbar")),
    # pairs of time and value
    "TwinCAT": Case("a.csv", f"{_TWINCAT}{_pairs()}EOF\n", kept=np.arange(COUNT - 1),
                    time_s=T[:-1]),
    "pairs": Case("a.csv", "time [ms],angle [deg],time [ms],pressure [kPa],time [ms],p_o [kPa]\n"
                  + _pairs(","), kept=np.arange(COUNT - 1), time_s=T[:-1]),
    "pairs, a name each": Case(
        "a.csv", "t_angle [ms];angle [deg];t_p [ms];pressure [kPa];t_po [ms];p_o [kPa]\n"
        + _pairs(";"), kept=np.arange(COUNT - 1), time_s=T[:-1]),
    # where the table begins
    "four lines": Case("a.csv", FOUR + text()),
    "title": Case("a.csv", "Experiment 12\n" + text()),
    "line of units": Case("a.csv", text(BARE, top="made by hand\n", values=[
        ANGLE, PRESSURE / 100.0, P_O / 100.0]).replace("p_o\n", "p_o\n[s],[deg],[bar],[bar]\n")),
    "keys and values": Case("a.csv", "Operator;A\nRate;100\nChannels;4\n" + text(separator=";")),
    # names in a comment
    "%time": Case("a.csv", text(
        ["%time", "field.seq", "field.frame_id", "field.angle", "field.pressure", "field.p_o"],
        _whole(1e-9, 1700000000 * 10**9), more=[np.arange(COUNT), ["base"] * COUNT])),
    "# of savetxt": Case("a.csv", text(["# time_s", *NAMES[1:]])),
    "# and blanks": Case("a.txt", "# " + text(separator=" ").replace("kPa\n", "kPa\n# begin\n")),
    "commas above blanks": Case("a.dat", "# time_s, angle_deg, pressure_kPa, p_o_kPa\n"
                                + text([], separator=" ")),
    # the first row is a sample
    "empty cell": Case("a.csv", text([], values=[
        ["", *(f"{a:g}" for a in ANGLE[1:])], PRESSURE, P_O]), edits=BY_NUMBER
        | {"skip_unusable": True}, kept=np.arange(1, COUNT), time_s=T[:-1]),
    "serial monitor": Case("a.txt", "".join(f"{s}{row}" for s, row in zip(
        SERIAL, rows(ANGLE, PRESSURE, P_O), strict=True)), edits=BY_NUMBER),
    "serial, names": Case("a.txt", f"{SERIAL[0]}angle_deg,pressure_kPa,p_o_kPa\n" + "".join(
        f"{s}{row}" for s, row in zip(SERIAL, rows(ANGLE, PRESSURE, P_O), strict=True))),
    "serial, words": Case("a.log", "".join(f"{s}{line}" for s, line in zip(
        SERIAL, IN_WORDS, strict=True))),
    # units beside the numbers
    "attributes": Case("a.h5", hdf5(_with_units)),
    "compound": Case("a.h5", hdf5(_compound)),
    "groups with clocks": Case("a.h5", hdf5(_groups)),
    # lines between
    "blank line": Case("a.csv", lines_with(30, "\n")),
    "text line": Case("a.csv", lines_with(30, "Pump on\n"), doubt="line 32: 'Pump on'"),
    "names again": Case("a.csv", lines_with(30, ",".join(NAMES) + "\n"), doubt="line 32"),
    "cut row": Case("a.csv", text().replace(
        rows(T, ANGLE, PRESSURE, P_O)[30], "0.3,1\n"), doubt="line 32",
        kept=np.delete(np.arange(COUNT), 30), time_s=np.delete(T, 30)),
    "word in a cell": Case("a.csv", text(values=[
        [*(f"{a:g}" for a in ANGLE[:30]), "ERR", *(f"{a:g}" for a in ANGLE[31:])], PRESSURE, P_O]),
        kept=np.delete(np.arange(COUNT), 30), time_s=np.delete(T, 30), doubt="1 values of"),
    # rounded clocks
    "five digits": Case("a.csv", text(["t", *NAMES[1:]], [
        f"{60 + k / 129:.5g}" for k in range(COUNT)]), 129.0, np.arange(COUNT) / 129.0),
    "whole ms": Case("a.csv", text(["ms", *NAMES[1:]], TICKS), 129.0, TICKS / 1e3),
    "30 frames": Case("a.csv", text(["time (s)", *NAMES[1:]], FRAMES), 30.0, FRAMES),
    "millis": Case("a.csv", text(["millis", *NAMES[1:]], 10 * np.arange(COUNT) + 5123)),
    # other quantities
    "current, moment": Case("a.csv", text(
        ["time_s", "actuator_current_A", "bending_moment_Nm", "free_memory", *NAMES[1:]],
        more=[ANGLE, PRESSURE, P_O])),
    "torque, volts": Case("a.csv", text(
        ["time_s", "motor torque (Nm)", "pressure sensor [V]", *NAMES[1:]], more=[ANGLE, P_O])),
    "speed, wish": Case("a.csv", text(
        ["time_s", "angle_rate_deg/s", "theta_d_deg", *NAMES[1:]], more=[P_O, ANGLE])),
    # any ending
    "log": Case("a.log", text()), "prn": Case("a.prn", text(separator="  ")),
    "no ending": Case("recording", text(separator="\t")),
    "UTF-16": Case("a.csv", text(["Zeit (s)", "Winkel (°)", *NAMES[2:]]).encode("utf-16")),
    "npz": Case("a.npz", _npz), "npy": Case("a.npy", _npy),
    # hours and days
    "hours": Case("a.csv", text(["time (h)", *NAMES[1:]], _at(3600.0))),
    "minutes": Case("a.csv", text(["Elapsed [min]", *NAMES[1:]], _at(60.0))),
    "days": Case("a.csv", text(["t_days", *NAMES[1:]], _at(86400.0))),
    # stamps that repeat
    "one repeats": Case("a.csv", text(time=np.where(T == 0.3, 0.29, T)), doubt="1 samples repeat",
                        kept=np.delete(np.arange(COUNT), 30), time_s=np.delete(T, 30)),
    "each twice": Case("a.csv", text(time=np.repeat(T[::2], 2), values=[
        np.repeat(v[::2], 2) for v in (ANGLE, PRESSURE, P_O)]), 50.0, T[::2], kept=EVEN),
    "the last repeats": Case("a.csv", text(time=np.minimum(T, T[-2])), kept=np.arange(COUNT - 1),
                             time_s=T[:-1]),
    # clocks that scatter
    "exponential": Case("a.csv", text(time=JITTER), (COUNT - 1) / JITTER[-1], JITTER),
    "uniform": Case("a.csv", text(time=NORMAL), (COUNT - 1) / (NORMAL[-1] - NORMAL[0]),
                    NORMAL - NORMAL[0]),
    "a pause": Case("a.csv", text(time=PAUSED), RATE_HZ, PAUSED),
    # languages
    "German": Case("a.csv", text(
        ["Zeit [s]", "Winkel [°]", "Istdruck [bar]", "Kammerdruck [bar]"], separator=";",
        decimal=",", values=[ANGLE, PRESSURE / 100.0, P_O / 100.0]).encode("latin-1")),
    "French": Case("a.csv", text(["Temps (s)", "Flexion (degrés)", "Pression (mbar)",
                                  "Pression chambre (mbar)"],
                                 values=[ANGLE, 10 * PRESSURE, 10 * P_O])),
    "Spanish": Case("a.csv", text(["Tiempo", "Ángulo", "Presión (kPa)", "Presión sellada (kPa)"])),
    "Italian": Case("a.csv", text(["Tempo (s)", "Angolo (gradi)", "Pressione (kPa)",
                                   "Pressione camera (kPa)"])),
    "Dutch": Case("a.csv", text(["tijd (s)", "hoek (graden)", "druk (kPa)", "kamerdruk (kPa)"])),
    "Japanese": Case("a.csv", text(["時間 [s]", "角度 [deg]", "圧力 [kPa]", "チャンバ圧 [kPa]"])
                     .encode("cp932")),
    "Chinese": Case("a.csv", text(["时间(s)", "弯曲角度(°)", "压力(kPa)", "密封腔压力(kPa)"])
                    .encode("gb18030")),
    "channels in turn": Case("a.csv", "time_s,angle_deg,pressure_kPa,p_o_kPa\n" + "".join(
        line for k in range(COUNT) for line in (
            f"{T[k]:g},{ANGLE[k]:g},,\n", f"{T[k] + 0.003:g},,{PRESSURE[k]:g},\n",
            f"{T[k] + 0.006:g},,,{P_O[k]:g}\n")), kept=np.arange(1, COUNT), time_s=T[:-1]),
    # as other programs write text
    "ControlDesk": Case("a.csv", '"type","timeplot"\n"path","Root/time","Root/angle",'
                        '"Root/pressure","Root/p_o"\n"trace_values","","","",""\n'
                        + text([], [""] * COUNT, more=[T])),
    "JSON lines": Case("a.jsonl", "".join(
        json.dumps(dict(zip(NAMES, row, strict=True))) + "\n"
        for row in np.column_stack([T, ANGLE, PRESSURE, P_O]).tolist())),
    "ros2 topic echo": Case("a.csv", text([], ["1700000000"] * COUNT, more=[
        [str(10**7 * k) for k in range(COUNT)]]), edits={
            f"channels.{name}": {"column": str(k + 2), "unit": "deg" if k == 0 else "kPa"}
            for k, name in enumerate(CHANNELS)}),
    "key above names": Case("a.tsv", "# rig 3\n# columns: time angle pressure p_o\n"
                            + text([], separator="\t")),
    "header of blanks": Case("a.txt", "Time (s) Angle (deg) Pressure (kPa) P_res (kPa)\n"
                             + text([], separator=" ")),
    # other formats
    "Excel": Case("a.xlsx", _excel("")), "Excel, title": Case("a.xlsx", _excel("Versuch 7")),
    "TDMS": Case("a.tdms", _tdms), "Parquet": Case("a.parquet", _parquet),
    "MCAP": Case("a.mcap", _mcap), "bag": Case("a.bag", _bag),
}  # fmt: skip
