"""The map of an import: which column of a foreign file is which channel, in which unit."""

import difflib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, Field, ValidationError, model_validator

from fprc.config.section import Section
from fprc.errors import ConfigError
from fprc.yaml_file import read_yaml


def _as_text(value: Any) -> Any:
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return str(value) if is_number else value


#: What YAML may have read as a number, as in ``unit: 1`` and ``column: 3``.
_AS_TEXT = BeforeValidator(_as_text)
Text = Annotated[str, _AS_TEXT]


class Column(Section):
    """Where a channel comes from: unit of (scale * column + offset)."""

    column: Text = Field(min_length=1, description="CSV header, HDF5 path or MATLAB variable")
    scale: float = Field(1.0, description="factor on the numbers of the file")
    offset: float = Field(0.0, description="added after the factor, in `unit`")
    note: str = Field("", description="what the reader of the log has to know")

    @model_validator(mode="after")
    def _something_else_is_explained(self) -> "Column":
        if self.unit == "1" and not self.note:
            raise ValueError(
                "unit 1 stands for a quantity that is something else; say which, and its unit, "
                "in `note`"
            )
        if self.scale == 0.0:
            raise ValueError("scale = 0 leaves nothing of the column; remove the key for 1")
        return self


class Pressure(Column):
    """Gauge pressure; for absolute readings in kPa use ``offset: -101.325``."""

    unit: Annotated[Literal["kPa", "Pa", "bar", "mbar", "psi", "MPa", "1"], _AS_TEXT]


class Angle(Column):
    """Angle."""

    unit: Annotated[Literal["deg", "rad", "1"], _AS_TEXT]


class Voltage(Column):
    """Voltage."""

    unit: Annotated[Literal["V", "mV", "1"], _AS_TEXT]


class Channels(Section):
    """Channels of a raw log, see data/raw/README.md; what is left out is absent."""

    p_exp_command_kpa: Pressure | None = None
    p_exp_kpa: Pressure | None = None
    theta_deg: Angle
    p_i_command_kpa: Pressure | None = None
    p_i_kpa: Pressure | None = None
    p_o_kpa: Pressure | None = None
    phi_deg: Angle | None = None
    valve_main_v: Voltage | None = None
    valve_reservoir_v: Voltage | None = None

    @model_validator(mode="after")
    def _pressure_to_predict(self) -> "Channels":
        if self.p_exp_kpa is None and self.p_exp_command_kpa is None:
            raise ValueError("p_exp_kpa or p_exp_command_kpa is missing; the models predict it")
        return self


class Time(Section):
    """Instants of the samples: a column and its unit, or a rate."""

    column: Text | None = Field(None, description="column that holds the instants")
    unit: Literal["s", "ms", "us", "min"] = Field("s", description="of the column")
    rate_hz: float | None = Field(None, gt=0, le=1e6, description="rate, without a column")

    @model_validator(mode="after")
    def _one_of_two(self) -> "Time":
        if (self.column is None) == (self.rate_hz is None):
            raise ValueError("give either column (with its unit) or rate_hz")
        if self.rate_hz is not None and "unit" in self.model_fields_set:
            raise ValueError("unit belongs to a column; remove it beside rate_hz")
        return self


class Csv(Section):
    """How a text file is written; only where the automatic answer is wrong."""

    separator: str | None = Field(None, min_length=1, max_length=1)
    decimal: Literal[".", ","] | None = None
    header_line: int | None = Field(None, ge=1, description="line of the names, from 1")
    data_line: int | None = Field(None, ge=2, description="line of the first sample, from 1")


class ImportMap(Section):
    """How one file becomes one raw log, or two: a training part and a test part."""

    experiment: Literal["sweep", "complex"] | None = None
    test_from_s: float | None = Field(
        None, gt=0, description="training part before, test part from here, from the first sample"
    )
    sample_rate_hz: float = Field(200.0, ge=1, le=1e5, description="rate of the raw log")
    time: Time
    start_s: float = Field(0.0, ge=0, description="cut before, from the first sample")
    end_s: float | None = Field(None, gt=0, description="cut after, from the first sample")
    channels: Channels
    csv: Csv = Csv()

    @model_validator(mode="after")
    def _cut_leaves_something(self) -> "ImportMap":
        if self.end_s is not None and self.end_s <= self.start_s:
            raise ValueError(f"end_s = {self.end_s:g}; must be above start_s = {self.start_s:g}")
        return self

    @model_validator(mode="after")
    def _one_log_or_two(self) -> "ImportMap":
        if (self.experiment is None) == (self.test_from_s is None):
            raise ValueError(
                "give either experiment, for the one log that `fprc import` writes, or "
                "test_from_s, for the two parts of `fprc readout`"
            )
        end_s = float("inf") if self.end_s is None else self.end_s
        if self.test_from_s is not None and not self.start_s < self.test_from_s < end_s:
            raise ValueError(
                f"test_from_s = {self.test_from_s:g}; must lie between start_s = {self.start_s:g} "
                f"and end_s = {end_s:g}"
            )
        return self

    def part(self, experiment: str) -> "ImportMap":
        """Return the map of one of the two parts."""
        parts = {
            # the sample at the border belongs to the test
            "sweep": {"end_s": self.test_from_s - 0.5 / self.sample_rate_hz},
            "complex": {"start_s": self.test_from_s},
        }
        alone = {"experiment": experiment, "test_from_s": None}
        return self.model_copy(update=alone | parts[experiment])


def read_map(path: Path | str) -> ImportMap:
    """Read and check the map of an import.

    Raises
    ------
    ConfigError
        The file is no YAML of keys and values; or lists every unknown key with
        the nearest valid one, every missing key, and every wrong value.
    """
    loaded = read_yaml(path)
    try:
        return ImportMap.model_validate(loaded)
    except ValidationError as error:
        lines = [_line(item) for item in error.errors()]
    noun = "error" if len(lines) == 1 else "errors"
    raise ConfigError("\n".join([f"{path}: {len(lines)} {noun} in the map:", *lines]))


def _line(item: Mapping[str, Any]) -> str:
    way = [str(part) for part in item["loc"]]
    key = ".".join(way)
    if item["type"] == "missing":
        return f"  {key}: missing; see docs/own-data.md"
    if item["type"] == "extra_forbidden":
        known = list(_section(way[:-1]).model_fields)
        nearest = difflib.get_close_matches(way[-1], known, n=1, cutoff=0.0)[0]
        return f"  {key}: unknown key; did you mean {'.'.join([*way[:-1], nearest])}?"
    message = item["msg"].removeprefix("Value error, ")
    message = message.replace("Input should", "must").replace("String should", "must")
    if item["type"] in ("model_type", "model_attributes_type"):
        message = "must hold keys and values"
    if item["type"] == "value_error" and not isinstance(item["input"], (str, int, float)):
        return f"  {key}: {message}" if key else f"  {message}"
    return f"  {key} = {item['input']}: {message}"


def _section(way: list[str]) -> type[BaseModel]:
    """Return the section that a list of keys leads to."""
    section: type[BaseModel] = ImportMap
    for part in way:
        kind = section.model_fields[part].annotation
        kinds = [kind, *getattr(kind, "__args__", ())]
        section = next(k for k in kinds if isinstance(k, type) and issubclass(k, BaseModel))
    return section
