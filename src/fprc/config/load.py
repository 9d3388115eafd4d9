"""Check a configuration and report every error at once."""

import os
from collections.abc import Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from fprc.config.problems import explained
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
        that is of the wrong type or out of range with the limit and a remedy.
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
    unread = []
    for layer in ({"rig": RIG}, *paths, over or {}):
        try:
            _merge_layer(merged, layer if isinstance(layer, Mapping) else read_yaml(layer))
        except ConfigError as error:
            unread.append(str(error))
    problems: dict[str, None] = {}
    restored: set[tuple[Any, ...]] = set()
    while True:
        try:
            settings = Settings.model_validate(merged)
            break
        except ValidationError as error:
            items = [item for item in error.errors() if item["loc"] not in restored]
            problems |= dict.fromkeys(explained(item, Settings, _PAGE) for item in items)
            # checks across several keys run only once each key is valid by itself
            single = [item["loc"] for item in items if _restore_default(merged, item)]
            restored.update(single)
            if not single:
                break
    if problems:
        sources = [*map(str, paths), *(["the command line"] if over else [])]
        files = f" ({', '.join(sources)})" if paths else ""
        unread.append(str(ConfigError.listing(problems, f"configuration{files}")))
    if unread:
        raise ConfigError("\n".join(unread))
    return settings


def _restore_default(config: Any, item: Mapping[str, Any]) -> bool:
    """Replace a wrong value by its default; return False if the error has no single value."""
    *sections, last = [part for part in item["loc"] if isinstance(part, str)] or [""]
    default: Any = Settings().model_dump()
    for part in sections:
        config, default = (
            inner.get(part) if isinstance(inner, dict) else None for inner in (config, default)
        )
    if not isinstance(config, dict) or last not in config:
        return False
    if isinstance(default, dict) and last in default:
        config[last] = default[last]
    else:
        del config[last]
    return True


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


def _merge_layer(merged: dict[str, Any], content: Mapping[str, Any]) -> None:
    """Merge a file over those before.

    The name of a rig stands for the contents of its file. These, or numbers beside ``fitted``, are
    a whole rig, completed by the defaults. Numbers alone change the rig of the layers before,
    which then counts as not fitted.
    """
    rig = content.get("rig")
    if isinstance(rig, str):
        # first all else: it is checked even if there is no such rig
        _merge(merged, deepcopy({key: value for key, value in content.items() if key != "rig"}))
        content = {**content, "rig": {}, **read_yaml(rig_file(rig))}
        merged |= {"rig": Settings().rig.model_dump(), "fitted": {"name": rig}}
    elif isinstance(rig, Mapping) and "fitted" in content:
        merged |= {"rig": Settings().rig.model_dump(), "fitted": {}}
    elif isinstance(rig, Mapping):
        merged["fitted"] = {"name": "changed"}
    _merge(merged, deepcopy(dict(content)))  # wrong values in it are replaced later


#: Mappings with keys that the user chooses: a given one replaces the whole default.
_REPLACED_KEYS = ("ranges",)


def _merge(into: dict[str, Any], other: Mapping[str, Any]) -> None:
    for key, value in other.items():
        nested = isinstance(value, Mapping) and isinstance(into.get(key), dict)
        if nested and key not in _REPLACED_KEYS:
            _merge(into[key], value)
        else:
            into[key] = value
