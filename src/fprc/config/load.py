"""Check a configuration and report every error at once."""

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import PydanticUndefined

from fprc.config.section import fields
from fprc.config.settings import Settings
from fprc.errors import ConfigError
from fprc.escape import in_words
from fprc.yaml_file import read_yaml

#: The rig of a configuration that gives none.
RIG = "paper"

#: Numbers that the paper prints.
PUBLISHED = Path(__file__).with_name("published.yaml")

#: Folders of the rigs that ``rig`` can name: this package's, and the user's.
_RIGS = (Path(__file__).with_name("rigs"), Path("config/rigs"))

#: Page that lists the keys.
_PAGE = "docs/configuration.md"

#: Configuration of the current folder.
_LOCAL = Path("config/config.yaml")


def rig_files() -> dict[str, Path]:
    """Return the file of each rig that ``rig`` can name.

    A file in ``config/rigs`` of the current folder replaces this package's rig of the same name.
    """
    files = {path.stem: path for folder in _RIGS for path in folder.glob("*.yaml")}
    return dict(sorted(files.items()))


def local_files() -> list[Path]:
    """Return ``config/config.yaml`` if the current folder has one; else no file: the defaults."""
    return [_LOCAL] if os.path.lexists(_LOCAL) else []


def check(config: Mapping[str, Any]) -> Settings:
    """Return the typed settings of a nested mapping, completed by the defaults.

    The default rig is the fitted one, not that of ``Settings()``. ``rig`` is the name of a rig,
    numbers that change the default rig, or, beside ``fitted``, a whole rig as in a rig's file.

    Raises
    ------
    ConfigError
        Lists every unknown key with the nearest valid one, and every value
        that is of the wrong type or out of range with the limit and a remedy. What
        does not go together is listed once each value is right by itself.
    """
    return from_files([], config)


def from_files(paths: Sequence[Path | str], over: Mapping[str, Any] | None = None) -> Settings:
    """Merge YAML files, later ones over earlier ones and ``over`` over all, and check the result.

    Raises
    ------
    ConfigError
        Lists every file that cannot be read, and why, and the errors that ``check`` lists.
    """
    merged = Settings().model_dump()
    problems = []
    for layer in ({"rig": RIG}, *paths, over or {}):
        content: Mapping[str, Any] = {}
        try:
            content = layer if isinstance(layer, Mapping) else read_yaml(layer)
            if isinstance(name := content.get("rig"), str):
                # all else is checked even if there is no such rig
                content = {**content, "rig": {}, "fitted": {}}
                content |= _merged({"fitted": {"name": name}}, read_yaml(rig_file(name)))
        except ConfigError as error:
            problems.append(str(error))
        merged = _with_layer(merged, content)
    try:
        settings = Settings.model_validate(merged)
    except ValidationError as error:
        lines = dict.fromkeys(explained(item, Settings, _PAGE) for item in error.errors())
        sources = [*map(str, paths), *(["the command line"] if over else [])]
        files = f" ({', '.join(sources)})" if paths else ""
        problems.append(str(ConfigError.listing(lines, f"configuration{files}")))
    if problems:
        raise ConfigError("\n".join(problems))
    return settings


def rig_file(name: str) -> Path:
    """Return the file of a rig.

    Raises
    ------
    ConfigError
        There is no such file; lists the names of the rigs.
    """
    files = rig_files()
    if name not in files:
        file = _RIGS[-1] / f"{name}.yaml"
        raise ConfigError(f"rig = {name}: there is no {file}; use {in_words(files, 'or')}")
    return files[name]


def _with_layer(merged: Mapping[str, Any], content: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings with a layer over them.

    A rig beside ``fitted`` is a whole one, completed by the defaults. Numbers alone change the rig
    of the layers before, which then counts as not fitted.
    """
    if "rig" not in content:
        return _merged(merged, content)
    whole = {"rig": Settings().rig.model_dump(), "fitted": {}}
    changed = {"fitted": {"name": "changed"}}
    return _merged({**merged, **(whole if "fitted" in content else changed)}, content)


#: Mappings with keys that the user chooses: a given one replaces the whole default.
_REPLACED_KEYS = ("ranges",)


def _merged(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    found = dict(below)
    for key, value in above.items():
        nested = isinstance(value, Mapping) and isinstance(below.get(key), Mapping)
        is_replaced = key in _REPLACED_KEYS or not nested
        found[key] = value if is_replaced else _merged(below[key], value)
    return found


def explained(item: Mapping[str, Any], section: type[BaseModel], page: str) -> str:
    """Return what is wrong, one error of pydantic, in a line.

    Parameters
    ----------
    section : type
        The section that was read.
    page : str
        The page that describes its keys.
    """
    *above, last = map(str, item["loc"] or [""])
    key = ".".join([*above, last])
    defaults = {name: default for name, default, *_ in fields(section)}
    kind, value = item["type"], item["input"]
    if kind == "missing":
        return f"{key}: missing; see {page}"
    if kind == "extra_forbidden":
        return f"{key}: unknown key; {_nearest(above, last, defaults, page)}"
    message = item["msg"].removeprefix("Value error, ").replace("a valid tuple", "a list")
    message = re.sub("^(Input|String|Keys) should", "must", message)
    if kind == "model_type":
        message = "must hold keys and values"
    # the messages of our checks name the value where that helps
    shown = "" if kind == "value_error" else f" = {value}"
    default = defaults.get(key, PydanticUndefined)
    # a default that is no value says nothing, and of the rig it is not what the chosen one has
    is_shown = default not in (PydanticUndefined, None, {}) and not key.startswith("rig.")
    remedy = f" (default: {default!r})" if is_shown else ""
    return f"{key}{shown}: {message}{remedy}" if key else message


def _nearest(above: list[str], last: str, known: Iterable[str], page: str) -> str:
    """Return the key that was probably meant, or else the keys that there are."""
    ways = [tuple(key.split(".")) for key in known]
    ways = list(dict.fromkeys(way[:depth] for way in ways for depth in range(1, len(way) + 1)))
    siblings = [name for *section, name in ways if section == above]
    near = get_close_matches(last, siblings, n=1)
    near += [name for name in siblings if name.startswith(last)]
    likely = [way for way in ways if way[-1] == last] or [(*above, name) for name in near]
    if not likely:
        return f"the keys are {in_words(siblings)}" if siblings else f"see {page}"
    return f"did you mean {'.'.join(likely[0])}?"
