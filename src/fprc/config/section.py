"""Base class of the configuration's sections, and helpers that declare their keys."""

from collections.abc import Iterator
from typing import Annotated, Any, TypeVar

from annotated_types import Interval
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationInfo, field_validator
from pydantic.fields import FieldInfo

T = TypeVar("T")
#: Lower and upper end of a range.
Pair = tuple[T, T]


class Section(BaseModel):
    """A group of settings; unknown keys, infinities, NaN and the character NUL are errors."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, allow_inf_nan=False, validate_default=True
    )

    @field_validator("*", mode="before")
    @classmethod
    def _no_nul_nor_truth_values_as_numbers(cls, value: Any, info: ValidationInfo) -> Any:
        parts = value if isinstance(value, (list, tuple)) else [value]
        if any(isinstance(part, str) and "\0" in part for part in parts):
            raise ValueError("contains the character NUL; remove it")
        if cls.model_fields[str(info.field_name)].annotation is bool:
            return value
        if any(isinstance(part, bool) for part in parts):
            raise ValueError("must be a number or a text, not true/false")
        return value


def quantity(default: float, unit: str, limits: Pair[float], meaning: str, source: str = "") -> Any:
    """Declare a number with unit, range, meaning and source."""
    low, high = limits
    extra: dict[str, Any] = {"unit": unit, "source": source}
    return Field(default, ge=low, le=high, description=meaning, json_schema_extra=extra)


def quantities(
    default: tuple[float, ...], unit: str, limits: Pair[float], meaning: str, source: str = ""
) -> Any:
    """Declare a list of numbers, each within the same range."""
    low, high = limits
    extra: dict[str, Any] = {"unit": unit, "source": source, "minimum": low, "maximum": high}
    return Field(default, min_length=1, description=meaning, json_schema_extra=extra)


def _rises(limits: Pair[float]) -> Pair[float]:
    if limits[0] >= limits[1]:
        raise ValueError(f"{limits} is empty; put the lower end first")
    return limits


def _differ(numbers: tuple[int, ...]) -> tuple[int, ...]:
    if len(set(numbers)) < len(numbers):
        raise ValueError(f"{numbers} repeats a number; give each once")
    return numbers


#: A pair whose lower end comes first, and numbers of which none is repeated.
Rising = Annotated[Pair[T], AfterValidator(_rises)]
Distinct = Annotated[tuple[T, ...], AfterValidator(_differ)]


def within(low: float, high: float) -> Interval:
    """Return the constraint on one number of a list."""
    return Interval(ge=low, le=high)


def fields(
    section: BaseModel, prefix: str = ""
) -> Iterator[tuple[str, Any, FieldInfo, type[BaseModel]]]:
    """Yield (dotted key, default, field, section) of every setting, depth first."""
    for name, field in type(section).model_fields.items():
        value = getattr(section, name)
        if isinstance(value, BaseModel):
            yield from fields(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value, field, type(section)
