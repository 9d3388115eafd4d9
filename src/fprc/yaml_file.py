"""Read YAML files strictly: no duplicate keys, and YAML 1.2 numbers."""

import re
from pathlib import Path
from typing import Any

import yaml

from fprc.errors import ConfigError
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
        The file cannot be read, is not YAML, or has no keys and values; lists every key that is
        repeated, with its line.
    """
    content = read_given(path, error=ConfigError, most_bytes=_LIMIT_BYTES)
    try:
        settings = _Reader(content.decode("utf-8")).whole()
    except (ValueError, yaml.YAMLError) as error:
        # PyYAML puts every place on a line after the sentence
        message = re.sub(r'\n\s+in "<.*>", (.*)', r" (\1)", str(error)).replace("\n", ", ")
        by_tab = isinstance(error, yaml.YAMLError) and b"\n\t" in content
        tab = "; indent with blanks, not with tabs" if by_tab else ""
        raise ConfigError(f"{path}: cannot be read as YAML: {message}{tab}") from error
    if not isinstance(settings, dict | None):
        raise ConfigError(f"{path}: must hold keys and values, not a {type(settings).__name__}")
    return settings or {}


class _Reader:
    """The events of a text, which stop at deep nesting and show aliases and repeated keys."""

    def __init__(self, text: str) -> None:
        self.events = yaml.parse(text, Loader=_LOADER)
        self.repeated: list[str] = []

    def whole(self) -> Any:
        """Return the only value of the text."""
        content, documents = None, 0
        for event in self.events:
            if isinstance(event, yaml.DocumentStartEvent):
                documents += 1
                if documents > 1:
                    raise _refused(event, "--- begins another document; use one file for each")
                content = self.value(next(self.events), 0)
        if self.repeated:
            raise ValueError("; ".join(self.repeated))
        return content

    def value(self, event: yaml.Event, level: int) -> Any:
        """Return the value that begins with an event; consumes its remaining events."""
        if level > _LIMIT_LEVELS:
            raise _refused(event, f"more than {_LIMIT_LEVELS} levels, the limit for settings")
        if isinstance(event, yaml.AliasEvent):
            raise _refused(event, f"*{event.anchor} is an alias of a value; write out the value")
        if event.tag is not None:
            raise _refused(event, f"remove the tag {event.tag}")
        if isinstance(event, yaml.SequenceStartEvent):
            items: list[Any] = []
            while not isinstance(event := next(self.events), yaml.SequenceEndEvent):
                items.append(self.value(event, level + 1))
            return items
        if isinstance(event, yaml.MappingStartEvent):
            content: dict[Any, Any] = {}
            while not isinstance(event := next(self.events), yaml.MappingEndEvent):
                key = self.value(event, level + 1)
                if isinstance(key, dict | list):
                    raise _refused(event, f"{key!s:.40}: a key must be a single word")
                if key in content:
                    why = f"{key!s:.40} is a duplicate; remove one of them"
                    self.repeated.append(str(_refused(event, why)))
                content[key] = self.value(next(self.events), level + 1)
            return content
        is_plain, _ = event.implicit
        return _scalar(event.value) if is_plain else event.value


def _refused(event: yaml.Event, why: str) -> ValueError:
    return ValueError(f"line {event.start_mark.line + 1}: {why}")


def _scalar(text: str) -> Any:
    for pattern, meaning in _CORE:
        if pattern.fullmatch(text):
            return meaning(text)
    return text
