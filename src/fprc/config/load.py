"""Check a configuration and report every error at once."""

import difflib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, get_args

import yaml
from pydantic import BaseModel, ValidationError

from fprc.config.settings import Settings
from fprc.errors import ConfigError


def check(config: Mapping[str, Any]) -> Settings:
    """Return the typed settings of a nested mapping.

    Raises
    ------
    ConfigError
        Lists every unknown key with the nearest valid one, and every value
        that is of the wrong type or out of range with the limit and a remedy.
    """
    try:
        return Settings.model_validate(dict(config))
    except ValidationError as error:
        lines = [_line(item) for item in error.errors()]
    noun = "error" if len(lines) == 1 else "errors"
    raise ConfigError("\n".join([f"{len(lines)} {noun} in the configuration:", *lines]))


def from_files(paths: Sequence[Path | str]) -> Settings:
    """Merge YAML files, later ones over earlier ones, and check the result."""
    merged: dict[str, Any] = {}
    for path in paths:
        try:
            loaded = yaml.safe_load(Path(path).read_text(encoding="utf-8")) or {}
        except (OSError, yaml.YAMLError) as error:
            raise ConfigError(f"{path}: cannot be read as YAML: {error}") from error
        if not isinstance(loaded, dict):
            raise ConfigError(f"{path}: must hold keys and values, not a {type(loaded).__name__}")
        _merge(merged, loaded)
    return check(merged)


def fields(section: type[BaseModel], prefix: str = "") -> Iterator[tuple[str, Any, type]]:
    """Yield (dotted key, field, section) of every setting, depth first."""
    for name, field in section.model_fields.items():
        key = f"{prefix}{name}"
        inner = [t for t in (field.annotation, *get_args(field.annotation)) if _is_section(t)]
        if not inner:
            yield key, field, section
        for model in inner:
            yield from fields(model, f"{key}.")


def _is_section(annotation: Any) -> bool:
    return isinstance(annotation, type) and issubclass(annotation, BaseModel)


def _merge(into: dict, other: Mapping) -> None:
    for key, value in other.items():
        if isinstance(value, Mapping) and isinstance(into.get(key), dict):
            _merge(into[key], value)
        else:
            into[key] = value


def _line(item: Mapping) -> str:
    key = ".".join(str(part) for part in item["loc"])
    known = {name: field for name, field, _ in fields(Settings)}
    if item["type"] == "extra_forbidden":
        return f"  {key}: unknown key; {_nearest(key, known)}"
    message = item["msg"].removeprefix("Value error, ").replace("Input should be", "must be")
    where = f"{key} = {item['input']}: " if key and item["type"] != "value_error" else ""
    default = known[key].default if key in known else None
    remedy = f"; remove the key for {default!r}" if default is not None else ""
    if not where and key:
        where = f"{key}: "
    return f"  {where}{message}{remedy}"


def _nearest(key: str, known: Mapping[str, Any]) -> str:
    groups = {name.rsplit(".", 1)[0] for name in known if "." in name}
    candidates = [*known, *groups]
    same_name = [name for name in candidates if name.split(".")[-1] == key.split(".")[-1]]
    close = same_name or difflib.get_close_matches(key, candidates, n=1, cutoff=0.0)
    return f"did you mean {close[0]}?"
