"""The map of an import: which column of a foreign file is which channel, in which unit."""

from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationError, field_validator, model_validator

from fprc.channels import TARGETS, unit_of
from fprc.config.load import explained
from fprc.config.section import Section
from fprc.errors import ConfigError
from fprc.given import read_yaml
from fprc.logs.quality import other_quantity
from fprc.recordings.names import SECONDS, factor_of

#: Text that YAML may have parsed as a number, as in ``unit: 1`` and ``column: 3``.
Text = Annotated[str, Field(coerce_numbers_to_str=True)]
#: Usual units by the unit of a channel, for messages and drafts; any other that pint knows will do.
USUAL = {
    "kPa": ("kPa", "Pa", "bar", "mbar", "psi", "MPa", "mmHg"),
    "deg": ("deg", "rad"),
    "V": ("V", "mV"),
}


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
    def units(self) -> dict[str, str]:
        """Unit of each channel; empty where it holds another quantity."""
        return {name: unit_of(name) * (spec["unit"] != "1") for name, spec in self.columns.items()}

    @property
    def notes(self) -> dict[str, str]:
        """Notes on channels, as a raw log has them: whether one holds another quantity."""
        units, specs = self.units, self.columns
        notes = {n: other_quantity(n) * (not units[n]) + spec["note"] for n, spec in specs.items()}
        return {name: note for name, note in notes.items() if note}

    def target(self, wanted: str) -> str:
        """Return ``command`` or ``measured``: the P_exp that is wanted, or else the other."""
        names = [name for name, channel in TARGETS.items() if channel in self.columns]
        return wanted if wanted in names else names[0]


def read_map(path: Path | str) -> ImportMap:
    """Read the map of an import; ConfigError lists all that is wrong in it."""
    return _valid(ImportMap, read_yaml(path), path)


def read_csv(path: Path | str) -> Csv:
    """Read the section ``csv`` of a map, whose other sections may be missing or wrong."""
    return _valid(Csv, read_yaml(path).get("csv", {}), path, "csv")


def _valid(section: Any, content: Any, path: Path | str, *above: str) -> Any:
    try:
        return section.model_validate(content)
    except ValidationError as error:
        problems = []
        for item in error.errors():
            place = (*above, *item["loc"])
            problem = explained({**item, "loc": place}, ImportMap, "docs/own-data.md")
            if item["input"] == "?":
                key = ".".join(map(str, place))
                problem = f"{key} = ?: the draft did not find it; give it, or delete the line"
            problems.append(problem)
        raise ConfigError.listing(problems, "map", file=path) from error
