"""Check a configuration and report every error at once."""

import difflib
import os
import re
from collections.abc import Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from fprc.config.section import fields
from fprc.config.settings import Settings
from fprc.errors import ConfigError
from fprc.yaml_file import read_yaml

#: The rig of a configuration that gives none.
RIG = "paper"

#: Numbers that the paper prints.
PUBLISHED = Path(__file__).with_name("published.yaml")

#: Folders of the rigs that ``rig`` can name: this package's, and the user's.
_RIGS = (Path(__file__).with_name("rigs"), Path("config/rigs"))

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
    return _checked([_with_whole_rig({"rig": RIG}), _with_whole_rig(config)], ())


def _checked(layers: Sequence[Mapping[str, Any]], files: Sequence[Path | str]) -> Settings:
    """Merge layers, later ones over earlier ones, and check the result."""
    remaining = Settings().model_dump()
    for layer in layers:
        _merge(remaining, deepcopy(dict(layer)))  # wrong values are removed below
    lines: dict[str, None] = {}
    removed: set[tuple[Any, ...]] = set()
    while True:
        try:
            settings = Settings.model_validate(remaining)
            break
        except ValidationError as error:
            lines |= dict.fromkeys(
                _line(item) for item in _true_errors(error) if item["loc"] not in removed
            )
            # checks across several keys run only once each key is valid by itself
            items = [item for item in error.errors() if _restore_default(remaining, item)]
            removed |= {item["loc"] for item in items}
            if not items:
                break
    if not lines:
        return settings
    noun = "error" if len(lines) == 1 else "errors"
    read = f" ({', '.join(map(str, files))})" if files else ""
    raise ConfigError("\n".join([f"{len(lines)} {noun} in the configuration{read}:", *lines]))


def _true_errors(error: ValidationError) -> list[Any]:
    """Return the errors, without those of lists that lack items only because these are wrong."""
    items = error.errors()
    wrong = {item["loc"][:-1] for item in items}
    missing = {item["loc"][:-1] for item in items if item["type"] == "missing"}

    def is_true(item: Any) -> bool:
        if item["type"] != "too_short":
            return True
        is_short = len(item["input"]) < item["ctx"]["min_length"]
        return item["loc"] not in (missing if is_short else wrong)

    return list(filter(is_true, items))


def _restore_default(config: Any, item: Mapping[str, Any]) -> bool:
    """Replace a wrong value by its default; return False if the error has no single value."""
    *sections, last = [part for part in item["loc"] if isinstance(part, str)] or [""]
    default: Any = Settings().model_dump()
    for part in sections:
        config = config.get(part) if isinstance(config, dict) else None
        default = default.get(part) if isinstance(default, dict) else None
    if not isinstance(config, dict) or last not in config:
        return False
    if item["type"] == "value_error" and isinstance(config[last], Mapping):
        return False
    if isinstance(default, dict) and last in default:
        config[last] = default[last]
    else:
        del config[last]
    return True


def from_files(paths: Sequence[Path | str], over: Mapping[str, Any] | None = None) -> Settings:
    """Merge YAML files, later ones over earlier ones and ``over`` over all, and check the result.

    Raises
    ------
    ConfigError
        Lists every file that cannot be read, and why; or the errors that ``check`` lists.
    """
    layers = [_with_whole_rig({"rig": RIG})]
    problems = []
    for path in paths:
        try:
            layers.append(_with_whole_rig(read_yaml(path)))
        except ConfigError as error:
            problems.append(str(error))
    if problems:
        raise ConfigError("\n".join(problems))
    return _checked([*layers, _with_whole_rig(over or {})], paths)


def rig_file(name: str) -> Path:
    """Return the file of a rig.

    Raises
    ------
    ConfigError
        There is no such file; lists the names of the rigs.
    """
    files = rig_files()
    if name not in files:
        own = _RIGS[-1] / f"{name}.yaml"
        raise ConfigError(f"rig = {name}: there is no {own}; use {' or '.join(files)}")
    return files[name]


def _with_whole_rig(config: Mapping[str, Any]) -> Mapping[str, Any]:
    """Replace the name of a rig by the contents of its file.

    Numbers beside ``fitted`` are a whole rig, completed by defaults, which replaces the rig of the
    layers before. Numbers alone change that rig, which then counts as not fitted.
    """
    rig = config.get("rig")
    whole: dict[str, Any] = {"rig": Settings().rig.model_dump(mode="json")}
    if isinstance(rig, str):
        whole["fitted"] = {"name": rig, "to": []}
        _merge(whole, read_yaml(rig_file(rig)))
        return {**config, **whole}
    if not isinstance(rig, Mapping):
        return config
    if "fitted" not in config:
        return {"fitted": {"name": "changed", "to": []}, **config}
    _merge(whole, config)
    return whole


#: Mappings with keys that the user chooses: a given one replaces the whole default.
_WHOLE = ("ranges",)


def _merge(into: dict[str, Any], other: Mapping[str, Any]) -> None:
    for key, value in other.items():
        nested = isinstance(value, Mapping) and isinstance(into.get(key), dict)
        if nested and key not in _WHOLE:
            _merge(into[key], value)
        else:
            into[key] = value


#: Keys and values of earlier versions, with their new names.
_RENAMED = {
    "sweeps": "grids",
    "grids.replicate_taps": "grids.readout_taps",
    "source = hardware": "rig",
    "tracking.printed_gains": "control.pd",
}

#: Keys of earlier versions that have no successor, and why.
_REMOVED = {
    "evaluation.verdict_seeds": "verdicts are those of all replicate_seeds",
    "tracking.candidate_kp_kpa_per_deg": "the gains are the printed ones, control.pd, and are not "
    "searched for; the law is control.feedback",
}


def _line(item: Mapping[str, Any]) -> str:
    key = ".".join(str(part) for part in item["loc"])
    if key in _REMOVED:
        return f"  {key}: was removed: {_REMOVED[key]}; delete the key"
    renamed = _RENAMED.get(key) or _RENAMED.get(f"{key} = {item['input']}")
    if renamed:
        was = item["input"] if isinstance(item["input"], str) else key
        return f"  {key}: {was} is now called {renamed}; rename it"
    defaults = {name: default for name, default, _, _ in fields(Settings())}
    if item["type"] == "extra_forbidden":
        return f"  {key}: unknown key; did you mean {_nearest(key, list(defaults))}?"
    if item["type"] == "invalid_key":
        named = ".".join(map(str, [*item["loc"][:-1], item["input"]]))
        return f"  {named}: unknown key; keys are words, such as seed"
    message = item["msg"].removeprefix("Value error, ").replace("Input should be", "must be")
    message = message.replace("a valid tuple", "a list")
    message = re.sub(r"Tuple should (have .*) after validation, not \d+", r"must \1", message)
    if item["type"] == "missing" and isinstance(item["loc"][-1], int):
        key, message = key.rpartition(".")[0], "must have 2 items"
    no_value = item["type"] == "missing" and isinstance(item["loc"][-1], str)
    no_value = no_value or item["type"] == "value_error"
    where = f"{key} = {item['input']}: " if key and not no_value else ""
    remedy = f"; remove the key for {defaults[key]!r}" if key in defaults else ""
    if not where and key:
        where = f"{key}: "
    return f"  {where}{message}{remedy}"


def _nearest(key: str, valid: Sequence[str]) -> str:
    """Return the valid key that the user probably meant."""
    parts = [name.split(".") for name in valid]
    prefixes = dict.fromkeys(".".join(part[:i]) for part in parts for i in range(1, len(part) + 1))
    section, _, last = key.rpartition(".")
    same_name = [name for name in prefixes if name.rpartition(".")[2] == last]
    siblings = [name for name in prefixes if name.rpartition(".")[0] == section]
    return (
        same_name
        or difflib.get_close_matches(key, siblings, n=1, cutoff=0.3)
        or difflib.get_close_matches(key, prefixes, n=1, cutoff=0.0)
    )[0]
