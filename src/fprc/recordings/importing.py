"""The map of an import: which column of a foreign file is which channel, in which unit."""

import difflib
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ValidationError,
    create_model,
    model_validator,
)

from fprc.channels import CHANNELS, TARGETS, Channel
from fprc.config.problems import explained
from fprc.config.section import Section
from fprc.errors import ConfigError
from fprc.recordings.names import SECONDS, factor_of, likely_channel
from fprc.yaml_file import read_yaml


def _as_text(value: Any) -> Any:
    return str(value) if isinstance(value, int | float) else value


#: Text that YAML may have parsed as a number, as in ``unit: 1`` and ``column: 3``.
_AS_TEXT = BeforeValidator(_as_text)
Text = Annotated[str, _AS_TEXT]


def _not_zero(value: float) -> float:
    if value == 0.0:
        raise ValueError("0 would replace the whole column by the offset")
    return value


class Column(Section):
    """Where a channel comes from; its values are scale * column + offset, in ``unit``."""

    column: Text = Field(
        min_length=1,
        pattern="[^?]",  # ? stands in a draft for what it did not find
        description="name as `--draft` prints it",
    )
    scale: Annotated[float, AfterValidator(_not_zero)] = Field(
        1.0, description="factor on the numbers of the file"
    )
    offset: float = Field(0.0, description="added after the factor, in `unit`")
    note: str = Field("", description="remark for readers of the log")
    time: Text | None = Field(None, description="column of its own clock, if it has one")
    unit: Text

    @model_validator(mode="after")
    def _names_another_quantity(self) -> Self:
        if self.unit == "1" and not self.note:
            raise ValueError("unit 1 stands for another quantity; name it and its unit in `note`")
        return self


#: Usual units by the unit of a channel, for messages and drafts; any other that pint knows will do.
USUAL = {
    "kPa": ("kPa", "Pa", "bar", "mbar", "psi", "MPa", "mmHg"),
    "deg": ("deg", "rad"),
    "V": ("V", "mV"),
}


def _column(channel: Channel) -> tuple[Any, Any]:
    """Return the type and the default of a channel's key; only what every import needs has none."""

    def of_its_quantity(unit: str) -> str:
        if factor_of(unit, channel.name) is None:
            usual = USUAL[channel.unit]
            near = difflib.get_close_matches(unit.lower(), [name.lower() for name in usual], 1, 0.5)
            meant = [f"did you mean {name}?" for name in usual if [name.lower()] == near]
            raise ValueError(
                f"{unit} is no unit of it; must be {', '.join(usual)}, another of its quantity, or "
                f"1 for another quantity; {''.join(meant)}".rstrip("; ")
            )
        return unit

    unit = Annotated[str, _AS_TEXT, AfterValidator(of_its_quantity)]
    column = create_model("Column", __base__=Column, __module__=__name__, unit=(unit, ...))
    return (column, ...) if "import" in channel.needed else (column | None, None)


_FIELDS: dict[str, Any] = {
    channel.name: _column(channel)
    for channel in CHANNELS
    if channel.kind in ("command", "sensor", "valve")
}


class _WithTarget(Section):
    @model_validator(mode="after")
    def _has_a_target(self) -> Self:
        if all(getattr(self, name) is None for name in TARGETS.values()):
            raise ValueError("p_exp_kpa or p_exp_command_kpa is missing; the models predict it")
        return self


#: Channels of a raw log, see data/raw/README.md; omitted channels are not in the log.
Channels = create_model("Channels", __base__=_WithTarget, __module__=__name__, **_FIELDS)


class Time(Section):
    """Times of the samples: a column and its unit, or a rate."""

    column: Text | None = Field(None, description="column that holds the times")
    unit: Literal[*SECONDS] = Field(  # type: ignore[valid-type]
        "s", description="unit of the column"
    )
    repeated: Literal["first", "mean"] | None = Field(
        None, description="what to take of samples that repeat a time stamp"
    )
    rate_hz: float | None = Field(None, gt=0, le=1e6, description="rate instead of a column")

    @model_validator(mode="after")
    def _one_clock(self) -> Self:
        if (self.column is None) == (self.rate_hz is None):
            raise ValueError("give either column (with its unit) or rate_hz")
        if self.rate_hz is not None and "unit" in self.model_fields_set:
            raise ValueError("unit belongs to a column; remove it beside rate_hz")
        return self


class Csv(Section):
    """Format of a text file; give only keys whose automatic detection is wrong."""

    separator: str | None = Field(None, pattern=r'^[^"\r\n]$', description="one character")
    decimal: Literal[".", ","] | None = None
    header_line: int | None = Field(None, ge=1, description="line of the names, from 1")
    data_line: int | None = Field(None, ge=2, description="line of the first sample, from 1")


class ImportMap(Section):
    """How one file becomes one raw log, or two: a training part and a test part."""

    experiment: Literal["sweep", "complex"] | None = None
    test_from_s: float | None = Field(
        None, gt=0, description="end of training and begin of test, s after the first sample"
    )
    sample_rate_hz: float | None = Field(
        None,
        ge=1,
        le=1e5,
        description="rate of the raw log; by default 200, or for `fprc readout` the recording's "
        "own, at most 200",
    )
    time: Time
    start_s: float = Field(0.0, ge=0, description="first time kept, s after the first sample")
    end_s: float | None = Field(None, gt=0, description="last time kept, s after the first sample")
    skip_unusable: bool = Field(
        False, description="leave out lines that are no samples, and samples with missing values"
    )
    channels: Channels
    csv: Csv = Csv()

    @model_validator(mode="after")
    def _parts_are_not_empty(self) -> Self:
        if (self.experiment is None) == (self.test_from_s is None):
            raise ValueError(
                "give either experiment, for the one log that `fprc import` writes, or "
                "test_from_s, for the two parts of `fprc readout`"
            )
        end_s = math.inf if self.end_s is None else self.end_s
        if end_s <= self.start_s:
            raise ValueError(f"end_s = {end_s:g}; must be above start_s = {self.start_s:g}")
        if self.test_from_s is not None and not self.start_s < self.test_from_s < end_s:
            raise ValueError(
                f"test_from_s = {self.test_from_s:g}; must lie between start_s = "
                f"{self.start_s:g} and end_s = {end_s:g}"
            )
        return self

    @property
    def rate_hz(self) -> float:
        """Sample rate of the raw log, Hz."""
        return self.sample_rate_hz or 200.0

    def part(self, experiment: str) -> "ImportMap":
        """Return the map of one of the two parts that ``test_from_s`` separates."""
        border_s = self.test_from_s or 0.0
        # the sample at the border belongs to the test
        ends = {"sweep": {"end_s": border_s - 0.5 / self.rate_hz}, "complex": {"start_s": border_s}}
        alone = {"experiment": experiment, "test_from_s": None}
        return self.model_copy(update=alone | ends[experiment])

    def of_whole(self, experiment: str) -> "ImportMap":
        """Return the map of a whole recording with the same columns."""
        whole = {"experiment": experiment, "test_from_s": None, "start_s": 0.0, "end_s": None}
        return self.model_copy(update=whole)


def read_map(path: Path | str) -> ImportMap:
    """Read and check the map of an import.

    Raises
    ------
    ConfigError
        The file is not YAML with keys and values; or lists every unknown key with the
        nearest valid one, every missing key, every wrong value, and, of sections without these,
        every contradiction.
    """
    try:
        return ImportMap.model_validate(read_yaml(path))
    except ValidationError as error:
        raise ConfigError.listing([*map(_explained, error.errors())], "map", file=path) from error


def read_csv(path: Path | str) -> Csv:
    """Read the section ``csv`` of a map, whose other sections may be missing or wrong.

    Raises
    ------
    ConfigError
        The file is not YAML with keys and values, or the section is wrong.
    """
    try:
        return Csv.model_validate(read_yaml(path).get("csv", {}))
    except ValidationError as error:
        items = ({**item, "loc": ("csv", *item["loc"])} for item in error.errors())
        raise ConfigError.listing([*map(_explained, items)], "map", file=path) from error


def _explained(item: Mapping[str, Any]) -> str:
    *above, last = map(str, item["loc"] or [""])
    likely = likely_channel(last) if above == ["channels"] else None
    if item["type"] == "extra_forbidden" and likely and likely.strength > 1:
        return f"channels.{last}: unknown key; did you mean channels.{likely.channel}?"
    if item["input"] == "?":
        key = ".".join([*above, last])
        return f"{key} = ?: the draft did not find it; give it, or delete the line"
    return explained(item, ImportMap, "docs/own-data.md")
