"""Files that users name: the one way to open and read them."""

import json
import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO

import yaml

from fprc.errors import ConfigError, FprcError, in_one_line


def open_given(
    path: Path | str, *, error: type[FprcError] = FprcError, most_bytes: int = 4 << 30
) -> BinaryIO:
    """Open a regular file that a user named, for reading; raise ``error`` if that cannot be."""
    try:
        # a pipe would block, and a device can be endless
        if os.path.exists(path) and not os.path.isfile(path):
            raise OSError(0, "no regular file")
        file = open(path, "rb")
    except (OSError, ValueError) as problem:  # ValueError: the path contains NUL
        why = getattr(problem, "strerror", None) or problem
        raise error(f"{path!s}: cannot be opened ({why}); check the path") from problem
    size = os.fstat(file.fileno()).st_size
    if size > most_bytes:
        file.close()
        raise error(f"{path}: has {size:,} bytes; must have at most {most_bytes:,}")
    return file


def read_given(
    path: Path | str, *, error: type[FprcError] = FprcError, most_bytes: int = 4 << 30
) -> bytes:
    """Return the content of a file that a user named; raise ``error`` if it cannot be read."""
    with open_given(path, error=error, most_bytes=most_bytes) as file:
        return file.read()


def refuse_repeats(paths: Sequence[str], why: str) -> None:
    """Raise ConfigError if a recording is given twice; ``why`` says what would be wrong."""
    places = [os.path.realpath(path) for path in paths]
    repeated = [path for i, path in enumerate(paths) if places[i] in places[:i]]
    if repeated:
        raise ConfigError(f"{', '.join(repeated)}: given twice; give each recording once: {why}")


def parse_object(text: str) -> dict[str, Any]:
    """Parse a JSON object; raise ValueError, or RecursionError, for any other text."""
    content = json.loads(text)
    if not isinstance(content, dict):
        raise ValueError("must be a JSON object")
    return content


def read_json(path: Path | str) -> dict[str, Any]:
    """Read a JSON file that holds an object; raise FprcError if it was cut or is something else."""
    try:
        return parse_object(read_given(path, most_bytes=1 << 28).decode("utf-8"))
    except (ValueError, RecursionError) as error:
        raise FprcError(
            f"{path}: {error}; it was damaged or edited: delete it, then repeat the command that "
            "made it"
        ) from error


def read_yaml(path: Path | str) -> dict[Any, Any]:
    """Read a YAML file of keys and values; an empty file gives an empty dict.

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
        if node.tag.endswith((":int", ":float")) and re.match(r"[-+]?0[\d_]|.*:", node.value):
            line = node.start_mark.line + 1
            raise ValueError(
                f"line {line}: {node.value:.40}: write a number without colons and leading zeros"
            )
        return super().construct_scalar(node)
