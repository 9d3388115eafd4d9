"""Read YAML files, in which no key may be repeated."""

import re
from pathlib import Path
from typing import Any

import yaml

from fprc.errors import ConfigError, in_one_line
from fprc.given import read_given


def read_yaml(path: Path | str) -> dict[Any, Any]:
    """Read a file of keys and values; an empty file gives an empty dict.

    ConfigError names the line of what is no YAML, of a repeated key, and of a number such as 0700
    or 1:30, which is another one in YAML 1.1 than in 1.2.
    """
    content = read_given(path, error=ConfigError, most_bytes=1_000_000)
    try:
        settings = yaml.load(content, Loader=_Loader)
    except (ValueError, RecursionError, yaml.YAMLError) as error:
        raise ConfigError(f"{path}: cannot be read as YAML: {in_one_line(error)}") from error
    if not isinstance(settings, dict | None):
        raise ConfigError(f"{path}: must hold keys and values, not a {type(settings).__name__}")
    return settings or {}


class _Loader(yaml.SafeLoader):
    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        names = [key.value for key, _ in node.value]
        for k, (key, _) in enumerate(node.value):
            if key.value in names[:k]:
                line = key.start_mark.line + 1
                raise ValueError(f"line {line}: {key.value!s:.40} is a duplicate; remove one")
        return super().construct_mapping(node, deep)

    def construct_scalar(self, node: Any) -> Any:
        # PyYAML, and with it Snakemake, reads YAML 1.1, in which 0700 is 448 and 1:30 is 90
        number = node.tag.endswith((":int", ":float"))
        if number and re.match(r"[-+]?0[\d_]|.*:", node.value):
            line = node.start_mark.line + 1
            raise ValueError(
                f"line {line}: {node.value:.40}: write a number without colons and leading zeros"
            )
        return super().construct_scalar(node)
