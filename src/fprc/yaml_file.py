"""Read the YAML files that people write: each key once, and numbers as they look."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from fprc.errors import ConfigError

#: The core schema of YAML 1.2; PyYAML has that of 1.1, where 010 is 8, 1:30 is 90 and `no` is
#: false. The lengths are far beyond any setting, and short of what Python refuses to print.
_CORE = tuple(
    (re.compile(pattern), meaning)
    for pattern, meaning in (
        ("(null|Null|NULL|~)?", lambda _: None),
        ("true|True|TRUE", lambda _: True),
        ("false|False|FALSE", lambda _: False),
        ("[-+]?[0-9]{1,400}", int),
        ("0o[0-7]{1,400}", lambda text: int(text[2:], 8)),
        ("0x[0-9a-fA-F]{1,400}", lambda text: int(text, 16)),
        (r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", float),
        (r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)", lambda text: float(text.replace(".", ""))),
    )
)

_LIMIT_BYTES = 1_000_000
_LIMIT_LEVELS = 50
_LIMIT_SHOWN = 40

#: The one in C is faster by eight times.
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_yaml(path: Path | str) -> dict[Any, Any]:
    """Read a file of keys and values, YAML 1.2 or JSON; an empty one holds none.

    Words without quotes are numbers, truth values or nothing by YAML's core
    schema: ``010`` is 10; ``1:30`` and ``no`` are texts. Aliases, tags and merge
    keys are no part of it: a value stands where it is set, and a small file
    cannot stand for a huge one.

    Raises
    ------
    ConfigError
        The file cannot be read, is no YAML, or holds no keys and values; or
        lists, with their lines, all keys that are given more than once and all
        else that is refused.
    """
    try:
        with open(path, "rb") as file:
            content = file.read(_LIMIT_BYTES + 1)
        if len(content) > _LIMIT_BYTES:
            raise ConfigError(
                f"{path}: is larger than {_LIMIT_BYTES} bytes, too large for settings"
            )
        found, problems = _parse(content.decode("utf-8"))
    except (OSError, ValueError, yaml.YAMLError) as error:
        raise ConfigError(f"{path}: cannot be read as YAML: {_said(error)}") from error
    if problems:
        noun = "error" if len(problems) == 1 else "errors"
        lines = [f"  line {line}: {what}" for line, what in sorted(problems)]
        raise ConfigError("\n".join([f"{path}: {len(problems)} {noun} in the file:", *lines]))
    if not isinstance(found, dict | None):
        raise ConfigError(f"{path}: must hold keys and values, not a {type(found).__name__}")
    return found or {}


def _parse(text: str) -> tuple[Any, list[tuple[int, str]]]:
    """Return what a text holds; and what is wrong with it, by line."""
    found, problems = None, []
    begun = False
    # events and not nodes: what is nested too deeply is never built, and aliases can be seen
    events = yaml.parse(text, Loader=_LOADER)
    for event in events:
        if isinstance(event, yaml.DocumentStartEvent):
            if begun:
                line = event.start_mark.line + 1
                problems.append((line, "--- begins another document; use one file for each"))
            begun = True
            found = _value(next(events), events, [], problems)
    return found, problems


def _value(
    event: yaml.Event, events: Iterator[yaml.Event], way: list[Any], problems: list[tuple[int, str]]
) -> Any:
    """Return the value that begins with an event, and take its other events."""
    line = event.start_mark.line + 1
    if len(way) > _LIMIT_LEVELS:
        raise ValueError(f"line {line}: more than {_LIMIT_LEVELS} levels, too many for settings")
    if isinstance(event, yaml.AliasEvent):
        what = f"*{event.anchor} stands for a value elsewhere; write out the value"
        problems.append((line, f"{_dotted(way)}: {what}"))
        return None
    if event.tag is not None:
        problems.append((line, f"{_dotted(way)}: remove the tag {event.tag}"))
    if isinstance(event, yaml.MappingStartEvent):
        return _mapping(events, way, problems)
    if isinstance(event, yaml.SequenceStartEvent):
        items: list[Any] = []
        while not isinstance(event := next(events), yaml.SequenceEndEvent):
            items.append(_value(event, events, [*way, len(items)], problems))
        return items
    is_plain, _ = event.implicit
    return _scalar(event.value) if is_plain else event.value


def _mapping(
    events: Iterator[yaml.Event], way: list[Any], problems: list[tuple[int, str]]
) -> dict[Any, Any]:
    given: dict[Any, list[tuple[Any, int]]] = {}
    while not isinstance(event := next(events), yaml.MappingEndEvent):
        line = event.start_mark.line + 1
        key = _value(event, events, [*way, "?"], problems)
        if isinstance(key, dict | list):
            problems.append((line, f"{_dotted([*way, key])}: a key must be a single word"))
            key = str(key)
        value = _value(next(events), events, [*way, key], problems)
        given.setdefault(key, []).append((value, line))
    for key, values in given.items():
        if len(values) > 1:
            (first, line), *_, (last, last_line) = values
            what = (
                f"{_dotted([*way, key])} is given {len(values)} times: {_short(first)} in line "
                f"{line}, {_short(last)} in line {last_line}; keep one"
            )
            problems.append((line, what))
    return {key: values[-1][0] for key, values in given.items()}


def _dotted(way: list[Any]) -> str:
    return ".".join(map(_short, way))


def _scalar(text: str) -> Any:
    for pattern, meaning in _CORE:
        if pattern.fullmatch(text):
            return meaning(text)
    return text


def _short(value: Any) -> str:
    """Return a value in one line."""
    shown = value if isinstance(value, str) and value.isprintable() else repr(value)
    return shown if len(shown) <= _LIMIT_SHOWN else f"{shown[: _LIMIT_SHOWN - 3]}..."


def _said(error: Exception) -> str:
    if not isinstance(error, yaml.MarkedYAMLError) or error.problem_mark is None:
        return " ".join(str(error).split())
    what = ", ".join(filter(None, [error.context, error.problem]))
    mark = error.problem_mark
    return f"line {mark.line + 1}, column {mark.column + 1}: {what}"
