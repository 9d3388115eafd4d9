"""Read YAML files strictly: no repeated keys, and YAML 1.2 numbers."""

import re
from pathlib import Path
from typing import Any

import yaml

from fprc.errors import ConfigError
from fprc.given import read_given

#: The core schema of YAML 1.2; PyYAML uses that of 1.1, where 010 is 8, 1:30 is 90 and `no` is
#: false.
_CORE = {
    "null": "(null|Null|NULL|~)?",
    "bool": "true|True|TRUE|false|False|FALSE",
    "int": "[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+",
    "float": r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?"
    r"|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
}

_LIMIT_BYTES = 1_000_000
_LIMIT_LEVELS = 50


def read_yaml(path: Path | str) -> dict[Any, Any]:
    """Read a file of keys and values, YAML 1.2 or JSON; an empty file gives an empty dict.

    Unquoted words are numbers, booleans or null according to YAML's core schema:
    ``010`` is 10; ``1:30`` and ``no`` are text. Aliases and merge keys are refused: every value is
    written where it is used, and a small file cannot expand to a huge one.

    Raises
    ------
    ConfigError
        The file cannot be read, is not YAML, or has no keys and values; lists every key that is
        repeated, with its line.
    """
    content = read_given(path, error=ConfigError, most_bytes=_LIMIT_BYTES)
    try:
        text = content.decode("utf-8")
        level = 0
        for event in yaml.parse(text, Loader=_Loader):
            level += isinstance(event, yaml.CollectionStartEvent)
            level -= isinstance(event, yaml.CollectionEndEvent)
            where = f"line {event.start_mark.line + 1}"
            if isinstance(event, yaml.AliasEvent):
                raise ValueError(f"{where}: *{event.anchor} is an alias; write out the value")
            if level > _LIMIT_LEVELS:
                raise ValueError(f"{where}: more than {_LIMIT_LEVELS} levels")
        loader = _Loader(text)
        settings = loader.get_single_data()
        if loader.repeated:
            raise ValueError("; ".join(loader.repeated))
    except (ValueError, yaml.YAMLError) as error:
        # PyYAML puts every place on a line after the sentence
        message = re.sub(r'\n\s+in "<.*>", (.*)', r" (\1)", str(error)).replace("\n", ", ")
        by_tab = isinstance(error, yaml.YAMLError) and b"\n\t" in content
        tab = "; indent with blanks, not with tabs" if by_tab else ""
        raise ConfigError(f"{path}: cannot be read as YAML: {message}{tab}") from error
    if not isinstance(settings, dict | None):
        raise ConfigError(f"{path}: must hold keys and values, not a {type(settings).__name__}")
    return settings or {}


class _Loader(yaml.CSafeLoader):
    """Loader of the core schema, which notes repeated keys."""

    yaml_implicit_resolvers: dict[Any, Any] = {}

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.repeated: list[str] = []

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        content = super().construct_mapping(node, deep)
        if len(content) < len(node.value):
            keys = [self.construct_object(key) for key, _ in node.value]
            self.repeated += [
                f"line {pair[0].start_mark.line + 1}: {key!s:.40} is a duplicate; remove one"
                for k, (key, pair) in enumerate(zip(keys, node.value, strict=True))
                if key in keys[:k]
            ]
        return content

    def construct_yaml_int(self, node: Any) -> int:
        text = self.construct_scalar(node)
        return int(text, 0 if text[:2] in ("0o", "0x") else 10)


for _name, _pattern in _CORE.items():
    _Loader.add_implicit_resolver(
        f"tag:yaml.org,2002:{_name}", re.compile(rf"(?:{_pattern})\Z"), None
    )
_Loader.add_constructor("tag:yaml.org,2002:int", _Loader.construct_yaml_int)
