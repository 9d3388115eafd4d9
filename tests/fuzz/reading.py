"""An independent reader of configurations (YAML 1.2) that uses no code under test.

A duplicate key has no value. Numbers are decimal unless they begin with 0x or 0o.
"""

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import yaml

_NUMBER = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_MOST = 100_000
#: Only the loader in C accepts a tab before a value.
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class UnclearError(Exception):
    """The text has no unique meaning."""


class Text(NamedTuple):
    """A value as text."""

    text: str


def read(data: bytes) -> dict[str, Any]:
    """Return nested keys with their values as text.

    Raises
    ------
    UnclearError
        Not a YAML mapping; a duplicate key; too large or recursive.
    """
    try:
        node = yaml.compose(data.decode("utf-8"), Loader=_LOADER)
        found = {} if node is None else _tree(node, [0], 0)
    except (UnicodeDecodeError, yaml.YAMLError, RecursionError, ValueError) as error:
        raise UnclearError(str(error)) from error
    if isinstance(found, Text) and found.text in ("", "~", "null"):
        return {}
    if not isinstance(found, dict):
        raise UnclearError("no keys and values")
    return found


def _tree(node: yaml.Node, count: list[int], depth: int) -> Any:
    count[0] += 1
    if count[0] > _MOST or depth > 200:
        raise UnclearError("endless")
    if isinstance(node, yaml.ScalarNode):
        return Text(node.value)
    if isinstance(node, yaml.SequenceNode):
        return [_tree(item, count, depth + 1) for item in node.value]
    found: dict[str, Any] = {}
    merged: dict[str, Any] = {}
    for key, value in node.value:
        if not isinstance(key, yaml.ScalarNode):
            raise UnclearError("a key is not text")
        inner = _tree(value, count, depth + 1)
        if key.value == "<<" and isinstance(inner, dict):
            merged |= inner
        elif key.value in found:
            raise UnclearError(f"{key.value}: duplicate key")
        else:
            found[key.value] = inner
    return merged | found


def differing(got: Any, said: Any, default: Any, key: str = "") -> list[str]:
    """Return the keys whose settings differ from the text.

    Parameters
    ----------
    got : dict
        The settings.
    said : dict
        See ``read``.
    default : dict
        Defaults of keys that the text does not have.
    """
    if isinstance(got, Mapping) and isinstance(said, dict):
        whole = key.endswith(".ranges")
        rest = {} if whole or not isinstance(default, Mapping) else default
        found = [f"{key}.{name}: unknown" for name in said if name not in got]
        for name, value in got.items():
            inner = said.get(name)
            if inner is not None:
                found += differing(value, inner, rest.get(name), f"{key}.{name}")
            elif whole or (name in rest and value != rest[name]):
                found.append(f"{key}.{name}: not said")
        return found
    if isinstance(got, (list, tuple)) and isinstance(said, list):
        if len(got) != len(said):
            return [f"{key}: {len(got)} values for {len(said)}"]
        pairs = enumerate(zip(got, said, strict=True))
        return [line for k, (a, b) in pairs for line in differing(a, b, None, f"{key}.{k}")]
    if isinstance(said, Text) and _says(said.text, got):
        return []
    return [f"{key}: {got!r} for {str(said)[:100]}"]


def _says(text: str, value: Any) -> bool:
    if isinstance(value, bool):
        return text.lower() in (("true", "yes", "on") if value else ("false", "no", "off"))
    if value is None:
        return text.lower() in ("", "~", "null")
    if isinstance(value, (int, float)):
        return _number(text) == value
    return text == value


def _number(text: str) -> float | None:
    plain = re.sub(r"(?<=[0-9])_(?=[0-9])", "", text.strip())
    if re.fullmatch(r"0x[0-9a-fA-F]+|0o[0-7]+", plain):
        return int(plain, 0)
    if re.fullmatch(r"[-+]?[0-9]{1,400}", plain):
        return int(plain)
    return float(plain) if _NUMBER.fullmatch(plain) else None
