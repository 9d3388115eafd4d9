"""The map of an import, and from a table to raw logs: channels, a uniform time grid, a picture."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, Self

import numpy as np
from pydantic import Field, ValidationError, field_validator, model_validator

from fprc import escape
from fprc.artifacts import sha256
from fprc.channels import TARGETS, unit_of
from fprc.config.load import explained
from fprc.config.section import Section
from fprc.errors import ConfigError, LogError
from fprc.given import read_yaml
from fprc.limits import LARGEST
from fprc.logs import read_columns, write_raw
from fprc.logs.quality import other_quantity
from fprc.recordings.clock import pauses_of, rate_of
from fprc.recordings.names import SECONDS, factor_of
from fprc.recordings.table import Table

#: Text that YAML may have parsed as a number, as in ``unit: 1`` and ``column: 3``.
Text = Annotated[str, Field(coerce_numbers_to_str=True)]
#: Usual units by the unit of a channel, for messages and drafts; any other that pint knows will do.
USUAL = {
    "kPa": ("kPa", "Pa", "bar", "mbar", "psi", "MPa", "mmHg"),
    "deg": ("deg", "rad"),
    "V": ("V", "mV"),
}

#: Most samples per channel that resampling may process.
MOST_POINTS = 10_000_000

#: Edges of pass band and stop band, as shares of the new Nyquist frequency.
PASS, STOP = 0.8, 1.0
#: Attenuation in the stop band, dB.
STOP_DB = 70.0
#: Half the length of the low-pass, in new samples (Kaiser's formula).
_HALF_TAPS = (STOP_DB - 7.95) / (2.285 * math.pi * (STOP - PASS)) / 2.0


class Column(Section):
    """Where a channel comes from; its values are scale * column + offset, in ``unit``."""

    column: Text = Field(min_length=1, pattern="[^?]")  # ? stands in a draft for what it lacks
    unit: Text
    scale: float = 1.0
    offset: float = 0.0  #: in ``unit``
    note: str = ""  #: remark for readers of the log
    time: Text | None = None  #: column of its own clock, if it has one


class Channels(Section):
    """Channels of a raw log, see data/raw/README.md; omitted channels are not in the log."""

    p_exp_command_kpa: Column | None = None
    p_exp_kpa: Column | None = None
    theta_deg: Column
    p_i_command_kpa: Column | None = None
    p_i_kpa: Column | None = None
    p_o_kpa: Column | None = None
    phi_deg: Column | None = None
    valve_main_v: Column | None = None
    valve_reservoir_v: Column | None = None

    @field_validator("*")
    @classmethod
    def _converts(cls, value: Column | None, info: Any) -> Column | None:
        quantity = unit_of(info.field_name)
        if value is not None and factor_of(value.unit, quantity) is None:
            raise ValueError(
                f"unit {value.unit} is none of its quantity; must be {', '.join(USUAL[quantity])}, "
                "another of its quantity, or 1 for another quantity"
            )
        if value is not None and value.unit == "1" and not value.note:
            raise ValueError("unit 1 stands for another quantity; name it and its unit in `note`")
        return value

    @model_validator(mode="after")
    def _has_a_target(self) -> Self:
        if self.p_exp_kpa is None and self.p_exp_command_kpa is None:
            raise ValueError("p_exp_kpa or p_exp_command_kpa is missing; the models predict it")
        return self


class Time(Section):
    """Times of the samples: a column and its unit, or a rate."""

    column: Text | None = None
    unit: Literal[*SECONDS] = "s"  # type: ignore[valid-type]
    repeated: Literal["first", "mean"] | None = None  #: of samples that repeat a time stamp
    rate_hz: float | None = Field(None, gt=0, le=1e6)

    @model_validator(mode="after")
    def _one_clock(self) -> Self:
        if (self.column is None) == (self.rate_hz is None):
            raise ValueError("give either column (with its unit) or rate_hz")
        return self


class Csv(Section):
    """Format of a text file; give only keys whose automatic detection is wrong."""

    separator: str | None = Field(None, pattern=r'^[^"\r\n]$')
    decimal: Literal[".", ","] | None = None
    header_line: int | None = Field(None, ge=1)  #: line of the names, from 1
    data_line: int | None = Field(None, ge=2)  #: line of the first sample, from 1


class Draft(Section, extra="ignore"):
    """What is read of a map that may be incomplete: how to read the file."""

    csv: Csv = Csv()


class ImportMap(Section):
    """How one file becomes one raw log, or, for `fprc readout`, two; times count from its begin."""

    experiment: Literal["sweep", "complex"] | None = None
    test_from_s: float | None = Field(None, gt=0)  #: where `fprc readout` divides its two logs
    sample_rate_hz: float | None = Field(None, ge=1, le=1e5)
    time: Time
    start_s: float = Field(0.0, ge=0)
    end_s: float | None = Field(None, gt=0)
    skip_unusable: bool = False  #: leave out lines that are no samples, and missing values
    channels: Channels
    csv: Csv = Csv()

    @property
    def columns(self) -> dict[str, dict[str, Any]]:
        """Entries of the channels that the map has, by channel."""
        return self.channels.model_dump(exclude_none=True)

    @property
    def notes(self) -> dict[str, str]:
        """Notes on channels, as a raw log has them: whether one holds another quantity."""
        notes = {}
        for name, spec in self.columns.items():
            begin = other_quantity(name) if spec["unit"] == "1" else ""
            if begin or spec["note"]:
                notes[name] = begin + spec["note"]
        return notes

    def target(self, wanted: str) -> str:
        """Return ``command`` or ``measured``: the P_exp that is wanted, or else the other."""
        names = [name for name, channel in TARGETS.items() if channel in self.columns]
        return wanted if wanted in names else names[0]


def read_map(path: Path | str, kind: Any = ImportMap) -> Any:
    """Read the map of an import, or only its ``Draft``; ConfigError lists all that is wrong."""
    try:
        return kind.model_validate(read_yaml(path))
    except ValidationError as error:
        problems = []
        for item in error.errors():
            problem = explained(item, ImportMap, "docs/own-data.md")
            if item["input"] == "?":
                key = ".".join(map(str, item["loc"]))
                problem = f"{key} = ?: the draft did not find it; give it, or delete the line"
            problems.append(problem)
        raise ConfigError.listing(problems, "map", file=path) from error


class Recording(NamedTuple):
    """Channels at their original time stamps, in the units of a raw log."""

    time_s: np.ndarray  #: time stamps, increasing, 0 at the first sample kept
    channels: dict[str, np.ndarray]
    start_s: float = 0.0  #: time stamp of the first sample kept, on the file's clock
    since_s: float = 0.0  #: of the first sample kept, since the first one of the file
    notes: tuple[str, ...] = ()  #: samples that were left out, and gaps that will be filled
    path: Path = Path()


@np.errstate(all="ignore")  # numbers that overflow are refused
def gather(table: Table, mapping: ImportMap) -> Recording:
    """Select, convert and cut the channels of a file; LogError says what cannot be used."""
    path, specs, time = table.path, mapping.columns, mapping.time
    asked = {name: spec["column"] for name, spec in specs.items()}
    asked |= {f"{name}.time": spec["time"] for name, spec in specs.items() if "time" in spec}
    asked |= {"time": time.column} if time.column else {}
    picked = table.pick(asked)
    clocks = {name: picked[f"{name}.time"] for name in specs if f"{name}.time" in asked}
    shared = [name for name in specs if name not in clocks]
    count = max(len(picked[name]) for name in shared or specs)
    stamps = picked.get("time", np.arange(count) / (time.rate_hz or 1.0))
    if any(len(picked[name]) != len(stamps) for name in shared):
        raise LogError(f"{path}: unequal numbers of samples; give each channel's clock, its `time`")
    for name, clock in clocks.items():
        values = picked[name]
        known = np.isfinite(clock + values) if len(clock) == len(values) else np.zeros(1, bool)
        if not known.any() or (np.diff(clock[known]) < 0.0).any():
            raise LogError(f"{path}: channels.{name}.time is no clock of its column")
        picked[name] = np.interp(stamps, clock[known], values[known], left=np.nan, right=np.nan)
    names = [*shared, *clocks]
    rows = np.array([stamps, *(picked[name] for name in names)])
    usable = np.isfinite(rows[: 1 + len(shared)] if mapping.skip_unusable else rows[:1]).all(axis=0)
    lost, notes = [], []
    if table.unusable:
        lines = "; ".join(table.unusable[:3])
        lost.append(f"lines that are no samples: {len(table.unusable)}: {lines}")
    if not usable.all():
        first = table.sample(int(np.argmin(usable)))
        lost.append(f"samples with missing values, the first {first}; in all: {np.sum(~usable)}")
    if lost and not mapping.skip_unusable:
        raise LogError(f"{path}: {'; '.join(lost)}; repair them, or give `skip_unusable: true`")
    notes += [f"left out: {line}" for line in lost]
    numbers = np.flatnonzero(usable)
    rows = rows[:, numbers]
    begins = np.flatnonzero(np.diff(rows[0], prepend=np.nan) != 0.0)
    repeats = len(numbers) - len(begins)
    if time.repeated and repeats:
        notes.append(f"{repeats} samples repeat a time stamp; the {time.repeated} was taken")
        if time.repeated == "mean":
            counts = np.diff(begins, append=len(numbers))
            rows[1:, begins] = np.add.reduceat(rows[1:], begins, axis=1) / counts
        numbers, rows = numbers[begins], rows[:, begins]
    stamps = rows[0]
    late = 1 + np.flatnonzero(np.diff(stamps) <= 0.0)
    if late.size:
        k = int(late[0])
        raise LogError(
            f"{path}: time: {table.sample(numbers[k])} at {stamps[k]:.16g} does not come after "
            f"{stamps[k - 1]:.16g}; in all: {late.size}; repair, or give time.repeated or rate_hz"
        )
    # subtract before converting, or stamps counted from 1970 would lose digits
    since_s = (stamps - stamps[:1]) * SECONDS[time.unit]
    last_s = np.inf if mapping.end_s is None else mapping.end_s
    # 1e-9: the time stamps are rounded
    kept = (since_s >= mapping.start_s - 1e-9) & (since_s <= last_s + 1e-9)
    # a channel's own clock may begin later or end earlier
    kept &= np.isfinite(rows[1 + len(shared) :]).all(axis=0)
    if kept.sum() < 2:
        raise LogError(
            f"{path}: {kept.sum()} samples lie from start_s to end_s; correct these or a clock"
        )
    numbers, since_s = numbers[kept], since_s[kept]
    picked = dict(zip(names, rows[1:, kept], strict=True))
    channels = {}
    for name, spec in specs.items():
        given, factor = picked[name], factor_of(spec["unit"], unit_of(name)) or 1.0
        channels[name] = (given * spec["scale"] + spec["offset"]) * factor
        bad = np.flatnonzero(~(np.abs(channels[name]) <= LARGEST))  # NaN is neither
        if bad.size:
            first = f"{table.sample(numbers[bad[0]])} is {given[bad[0]]:g}"
            raise LogError(
                f"{path}: {name}: {spec['column']}: {first}; not finite or above {LARGEST:g}: "
                f"{bad.size}; correct the unit, cut them off by start_s and end_s, or give "
                "`skip_unusable: true`"
            )
    first_s = float(since_s[0])
    time_s, start_s = since_s - first_s, float(stamps[0] * SECONDS[time.unit]) + first_s
    gaps, steps = pauses_of(time_s), np.diff(time_s)
    if gaps.size:
        longest = "from {:.4g} to {:.4g} s".format(*time_s[gaps[steps[gaps].argmax()] + [0, 1]])
        notes.append(f"gaps in the clock, filled by interpolation: {gaps.size}, longest {longest}")
    return Recording(time_s, channels, start_s, first_s, tuple(notes), path)


@np.errstate(all="ignore")  # too many points are refused
def resample(recording: Recording, rate_hz: float) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return times and channels on a uniform grid that begins at the first sample.

    Where the grid coincides with the time stamps, values are copied. Elsewhere they are
    interpolated linearly, which does not overshoot at held values and gaps; to a lower rate at a
    multiple of it, and then a low-pass without delay removes aliases.
    LogError: it is shorter than a sample, or takes more than ``MOST_POINTS``.
    """
    from scipy.signal import fftconvolve, firwin, kaiser_beta  # slow to import

    time_s = recording.time_s
    span_s, ratio = float(time_s[-1]), rate_of(time_s) / rate_hz
    points = max(1.0, 2.0 * ratio) * (span_s * rate_hz + 2.0 * _HALF_TAPS)
    if not (span_s * rate_hz >= 1.0 and points <= MOST_POINTS):
        k = int(np.argmax(np.diff(time_s)))
        raise LogError(
            f"{recording.path}: {span_s:.4g} s at {rate_hz:g} Hz take {points:.2g} numbers, not 1 "
            f"to {MOST_POINTS:.0e}: check the clock, whose longest step is at {time_s[k]:.10g} s"
        )
    factor = max(round(ratio), 1)  # how much finer the grid of the low-pass is; 1: there is none
    even_s = np.arange(len(time_s)) / (factor * rate_hz)
    aligned = bool(np.abs(time_s - even_s).max() <= 1e-3 / (factor * rate_hz))
    if not aligned:
        # up to 1.01 it is the same rate, with clock error; above, where values are
        # interpolated, the grid is twice as fine, so that less is lost
        factor = 1 if ratio <= 1.01 else math.ceil(2.0 * ratio)
    samples = math.floor(span_s * rate_hz + 1e-6) + 1
    fine_s = np.arange((samples - 1) * factor + 1) / (factor * rate_hz)
    half, edge = math.ceil(_HALF_TAPS * factor) + 1, 0.5 * (PASS + STOP) / factor
    resampled = {}
    for name, values in recording.channels.items():
        fine = values[: len(fine_s)] if aligned else np.interp(fine_s, time_s, values)
        if factor > 1:
            taps = firwin(2 * half + 1, edge, window=("kaiser", kaiser_beta(STOP_DB)))
            padded = np.pad(fine, half, mode="reflect", reflect_type="odd")
            fine = fftconvolve(padded, taps, mode="valid")[::factor]
        resampled[name] = np.array(fine)
    return np.arange(samples) / rate_hz, resampled


def write_log(
    raw: Path | str, recording: Recording, time_s: np.ndarray, channels: Mapping[str, np.ndarray],
    mapping: ImportMap,
) -> None:  # fmt: skip
    """Write what was resampled of a recording as a raw log."""
    notes, source = mapping.notes, recording.path
    if recording.notes:
        notes["time_s"] = "; ".join(recording.notes)
    write_raw(
        raw,
        {"time_s": time_s - time_s[0], **channels},
        experiment=mapping.experiment,
        source="import",
        sample_rate_hz=mapping.sample_rate_hz,
        seed=0,
        rig={},
        imported_from=escape.visible(source.name),
        imported_sha256=sha256(str(source)),
        imported_start_s=recording.start_s + float(time_s[0]),
        map=json.dumps(mapping.model_dump(exclude_none=True)),
        notes=json.dumps(notes),
    )


def is_imported(old: Path | str) -> bool:
    """Return whether a file is a raw log that an import wrote."""
    try:
        return bool(read_columns(old, ()).attributes.get("source") == "import")
    except LogError:
        return False
