"""Read YAML files strictly: no duplicate keys, and YAML 1.2 numbers."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from fprc.errors import ConfigError
from fprc.escape import visible
from fprc.given import read_given

#: The core schema of YAML 1.2; PyYAML uses that of 1.1, where 010 is 8, 1:30 is 90 and `no` is
#: false. Digits are limited to 400: enough for any setting, and few enough for Python to print.
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

#: The C loader is eight times as fast.
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_yaml(path: Path | str) -> dict[Any, Any]:
    """Read a file of keys and values, YAML 1.2 or JSON; an empty file gives an empty dict.

    Unquoted words are numbers, booleans or null according to YAML's core schema:
    ``010`` is 10; ``1:30`` and ``no`` are text. Aliases, tags and merge keys are
    refused: every value is written where it is used, and a small file cannot
    expand to a huge one.

    Raises
    ------
    ConfigError
        The file cannot be read, is not YAML, or has no keys and values. All duplicate keys
        and all other refused content are listed with their lines.
    """
    content = read_given(path, error=ConfigError, most_bytes=_LIMIT_BYTES)
    try:
        settings, problems = _parse(content.decode("utf-8"))
    except (ValueError, yaml.YAMLError) as error:
        # PyYAML puts every place on a line after the sentence
        message = re.sub(r'\n\s+in "<.*>", (.*)', r" (\1)", str(error)).replace("\n", ", ")
        tab = "; indent with blanks, not with tabs" if b"\n\t" in content else ""
        raise ConfigError(f"{path}: cannot be read as YAML: {message}{tab}") from error
    if problems:
        lines = [f"line {line}: {what}" for line, what in sorted(problems)]
        raise ConfigError.listing(lines, "file", file=path)
    if not isinstance(settings, dict | None):
        raise ConfigError(f"{path}: must hold keys and values, not a {type(settings).__name__}")
    return settings or {}


def _parse(text: str) -> tuple[Any, list[tuple[int, str]]]:
    """Return the parsed content, and the problems with their line numbers."""
    content, problems = None, []
    has_document = False
    # parse events, not nodes: this stops at deep nesting, and shows aliases
    events = yaml.parse(text, Loader=_LOADER)
    for event in events:
        if isinstance(event, yaml.DocumentStartEvent):
            if has_document:
                line = event.start_mark.line + 1
                problems.append((line, "--- begins another document; use one file for each"))
            has_document = True
            content = _value(next(events), events, [], problems)
    return content, problems


def _value(
    event: yaml.Event,
    events: Iterator[yaml.Event],
    keys: list[Any],
    problems: list[tuple[int, str]],
) -> Any:
    """Return the value that begins with an event; consumes its remaining events."""
    line = event.start_mark.line + 1
    if len(keys) > _LIMIT_LEVELS:
        raise ValueError(f"line {line}: more than {_LIMIT_LEVELS} levels, the limit for settings")
    if isinstance(event, yaml.AliasEvent):
        what = f"*{event.anchor} is an alias of another value; write out the value"
        problems.append((line, f"{_dotted(keys)}: {what}"))
        return None
    if event.tag is not None:
        problems.append((line, f"{_dotted(keys)}: remove the tag {event.tag}"))
    if isinstance(event, yaml.MappingStartEvent):
        return _mapping(events, keys, problems)
    if isinstance(event, yaml.SequenceStartEvent):
        items: list[Any] = []
        while not isinstance(event := next(events), yaml.SequenceEndEvent):
            items.append(_value(event, events, [*keys, len(items)], problems))
        return items
    is_plain, _ = event.implicit
    return _scalar(event.value) if is_plain else event.value


def _mapping(
    events: Iterator[yaml.Event], keys: list[Any], problems: list[tuple[int, str]]
) -> dict[Any, Any]:
    content: dict[Any, Any] = {}
    lines: dict[Any, int] = {}
    while not isinstance(event := next(events), yaml.MappingEndEvent):
        line = event.start_mark.line + 1
        key = _value(event, events, [*keys, "?"], problems)
        if isinstance(key, dict | list):
            problems.append((line, f"{_dotted([*keys, key])}: a key must be a single word"))
            key = str(key)
        elif key in lines:
            what = f"is a duplicate of line {lines[key]}; remove one of them"
            problems.append((line, f"{_dotted([*keys, key])} {what}"))
        lines.setdefault(key, line)
        content[key] = _value(next(events), events, [*keys, key], problems)
    return content


def _dotted(keys: list[Any]) -> str:
    return ".".join(visible(str(key))[:40] for key in keys)


def _scalar(text: str) -> Any:
    for pattern, meaning in _CORE:
        if pattern.fullmatch(text):
            return meaning(text)
    return text
