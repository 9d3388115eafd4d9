"""Base class of the configuration's sections, and helpers that declare their keys."""

from collections.abc import Iterable, Iterator
from types import UnionType
from typing import Annotated, Any, Self, TypeVar, get_args, get_origin

from pydantic import AfterValidator, BaseModel, Field, field_validator, model_validator
from pydantic.fields import FieldInfo

from fprc.limits import Limit

T = TypeVar("T")


class Section(BaseModel, extra="forbid", frozen=True, allow_inf_nan=False, validate_default=True):
    """A group of settings; unknown keys, infinities and NaN are errors."""

    def changed(self, **values: Any) -> Self:
        """Return a copy with other values, which are not checked."""
        return self.model_copy(update=values)

    @field_validator("*", mode="before")
    @classmethod
    def _no_truth_values_as_numbers(cls, value: Any, info: Any) -> Any:
        parts = value if isinstance(value, (list, tuple)) else [value]
        field = cls.model_fields[info.field_name]
        if field.annotation is not bool and any(isinstance(part, bool) for part in parts):
            raise ValueError("must not be true or false")
        return value

    def _problems(self) -> Iterable[str]:
        """Yield what does not go together in this section."""
        return ()

    @model_validator(mode="after")
    def _goes_together(self) -> Self:
        if problems := [*self._problems()]:
            raise ValueError("\n  ".join(problems))
        return self


def quantity(
    default: float | tuple[float, ...] | None,
    limits: tuple[float, float] | Limit,
    meaning: str,
    source: str = "",
    unit: str = "",
) -> Any:
    """Declare a number, or a list of numbers; the key ends in the unit, unless one is given."""
    described = f"{meaning} [{unit}]" if unit else meaning
    field: Any = Field(default, description=described, json_schema_extra={"source": source})
    field.metadata.append(Limit(*limits))
    return field


def limit_of(field: FieldInfo) -> Limit | None:
    """Return the ends of a number, or of each number of a list; None if it has none."""
    return next((entry for entry in field.metadata if isinstance(entry, Limit)), None)


def _rise(limits: tuple[float, float]) -> tuple[float, float]:
    if limits[0] >= limits[1]:
        raise ValueError(f"{limits} is empty; put the lower end first")
    return limits


def _differ(items: tuple[T, ...]) -> tuple[T, ...]:
    if len(set(items)) < len(items):
        raise ValueError(f"{items} must differ")
    return items


#: One or more items; two or three of them or more, none repeated; a pair whose lower end is first.
NotEmpty = Annotated[tuple[T, ...], Field(min_length=1)]
Distinct = Annotated[tuple[T, ...], Field(min_length=2), AfterValidator(_differ)]
Grid = Annotated[tuple[T, ...], Field(min_length=3), AfterValidator(_differ)]
Rising = Annotated[tuple[float, float], AfterValidator(_rise)]


def section_of(field: FieldInfo) -> type[BaseModel] | None:
    """Return the section that a key holds, also if it may be null; None if it holds a value."""
    whole = field.annotation
    kinds = get_args(whole) if get_origin(whole) is UnionType else [whole]
    sections = (kind for kind in kinds if isinstance(kind, type) and issubclass(kind, BaseModel))
    return next(sections, None)


def fields(
    section: type[BaseModel], default: Any = None, prefix: str = ""
) -> Iterator[tuple[str, Any, FieldInfo, type[BaseModel]]]:
    """Yield (dotted key, default, field, section) of every setting, depth first."""
    for name, field in section.model_fields.items():
        value = getattr(default, name) if isinstance(default, BaseModel) else field.default
        if inner := section_of(field):
            yield from fields(inner, value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value, field, section
