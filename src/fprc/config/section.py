"""Base class of the configuration's sections, and helpers that declare their keys."""

from collections.abc import Iterator
from types import UnionType
from typing import Annotated, Any, TypeVar, Union, get_args, get_origin

from annotated_types import Ge, Interval, Le
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationInfo, field_validator
from pydantic.fields import FieldInfo

T = TypeVar("T")
#: Lower and upper end of a range.
Pair = tuple[T, T]

#: Symbols of units, by the words that stand for them in keys.
_SYMBOLS = {
    "abs": "abs", "deg": "deg", "deg3": "deg^3", "hz": "Hz", "kpa": "kPa", "min": "min",
    "ml": "mL", "rad": "rad", "s": "s", "s2": "s^2", "v": "V",
}  # fmt: skip


def unit_of(key: str) -> str:
    """Return the unit that ends a key, as in ``ki_v_per_kpa_s``; ``-`` if there is none."""
    words = key.split("_")
    begin = len(words)
    while begin and words[begin - 1] in {*_SYMBOLS, "per"}:
        begin -= 1
    over, _, under = " ".join(_SYMBOLS.get(word, word) for word in words[begin:]).partition("per")
    if not under:
        return over or "-"
    under = under.strip()
    return f"{over.strip() or 1}/{f'({under})' if ' ' in under else under}"


def _add_units(schema: dict[str, Any]) -> None:
    for key, declared in schema["properties"].items():
        if "unit" in declared:
            declared["unit"] = declared["unit"] or unit_of(key)


class Section(BaseModel):
    """A group of settings; unknown keys, infinities, NaN and the character NUL are errors."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,
        validate_default=True,
        json_schema_extra=_add_units,
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


def quantity(
    default: float, limits: Pair[float], meaning: str, source: str = "", unit: str = ""
) -> Any:
    """Declare a number with its range, meaning and source; its key ends in its unit if it can."""
    low, high = limits
    extra: dict[str, Any] = {"unit": unit, "source": source}
    return Field(default, ge=low, le=high, description=meaning, json_schema_extra=extra)


def quantities(default: tuple[float, ...], meaning: str, source: str = "", unit: str = "") -> Any:
    """Declare a list of numbers, whose annotation has their range."""
    extra: dict[str, Any] = {"unit": unit, "source": source}
    return Field(default, description=meaning, json_schema_extra=extra)


def within(low: float, high: float) -> Interval:
    """Return the constraint on one number of a list."""
    return Interval(ge=low, le=high)


def limits_of(field: FieldInfo) -> Pair[float] | None:
    """Return the range of a number, or of each number of a list; None if it has none."""
    bounds: list[Any] = list(field.metadata)
    for part in get_args(field.annotation)[:1]:
        bounds += getattr(part, "__metadata__", ())
    ends: list[Any] = [each.ge for each in bounds if isinstance(each, (Ge, Interval))]
    ends += [each.le for each in bounds if isinstance(each, (Le, Interval))]
    return (ends[0], ends[1]) if len(ends) == 2 else None


def _are_given(items: tuple[T, ...]) -> tuple[T, ...]:
    if not items:
        raise ValueError("must have at least 1 item")
    return items


def _rise(limits: Pair[float]) -> Pair[float]:
    if limits[0] >= limits[1]:
        raise ValueError(f"{limits} is empty; put the lower end first")
    return limits


def _differ(items: tuple[T, ...]) -> tuple[T, ...]:
    if len(set(items)) < max(2, len(items)):
        raise ValueError(f"{items} must be two or more, each given once")
    return items


#: One or more items; two or more, of which none is repeated; a pair whose lower end comes first.
#: These check only valid items, so that a wrong item is one error.
NotEmpty = Annotated[tuple[T, ...], AfterValidator(_are_given)]
Distinct = Annotated[tuple[T, ...], AfterValidator(_differ)]
Rising = Annotated[Pair[T], AfterValidator(_rise)]


def section_of(field: FieldInfo) -> type[BaseModel] | None:
    """Return the section that a key holds, also if it may be null; None if it holds a value."""
    kinds = [field.annotation]
    if get_origin(field.annotation) in (Union, UnionType):
        kinds = list(get_args(field.annotation))
    sections = (kind for kind in kinds if isinstance(kind, type) and issubclass(kind, BaseModel))
    return next(sections, None)


def fields(
    section: type[BaseModel], default: Any = None, prefix: str = ""
) -> Iterator[tuple[str, Any, FieldInfo, type[BaseModel]]]:
    """Yield (dotted key, default, field, section) of every setting, depth first.

    Parameters
    ----------
    default : Section, optional
        Holds the defaults, if they are not those of the class.
    """
    for name, field in section.model_fields.items():
        value = getattr(default, name) if isinstance(default, BaseModel) else field.default
        inner = section_of(field)
        if inner:
            yield from fields(inner, value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value, field, section
