"""Read, check and describe a configuration; all its errors are reported at once."""

import inspect
import json
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from functools import reduce
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import yaml
from pydantic import BaseModel, ValidationError
from pydantic_core import PydanticUndefined

from fprc.config.section import fields, limit_of
from fprc.config.settings import Settings
from fprc.errors import ConfigError
from fprc.escape import in_words
from fprc.given import read_yaml

#: The rig of a configuration that gives none.
RIG = "paper"

#: Folders of the rigs that ``rig`` can name: this package's, and the user's.
_RIGS = (Path(__file__).with_name("rigs"), Path("config/rigs"))


def rig_files() -> dict[str, Path]:
    """Return the file of each rig that ``rig`` can name; one of the user replaces ours."""
    files = {path.stem: path for folder in _RIGS for path in folder.glob("*.yaml")}
    return dict(sorted(files.items()))


def rig_file(name: str) -> Path:
    """Return the file of a rig; raise ConfigError, which lists the rigs, if there is none."""
    files = rig_files()
    if name not in files:
        file = _RIGS[-1] / f"{name}.yaml"
        raise ConfigError(f"rig = {name}: there is no {file}; use {in_words(files, 'or')}")
    return files[name]


def from_files(paths: Sequence[Path | str] = (), over: Mapping[str, Any] | None = None) -> Settings:
    """Merge YAML files, later ones over earlier ones and ``over`` over all, and ``check`` them.

    Without files, ``config/config.yaml`` counts if the current folder has one.
    """
    local = Path("config/config.yaml")
    if not paths and os.path.lexists(local):
        paths = [local]
    return check(reduce(_merged, [*map(read_yaml, paths), over or {}]))


def check(config: Mapping[str, Any]) -> Settings:
    """Return the typed settings of a nested mapping, completed by the defaults.

    ``rig`` is the name of a rig, or has its ``name``, by default ``RIG``, and numbers that differ
    from those of its file. The default rig is that of ``RIG``, not that of ``Settings()``.

    Raises
    ------
    ConfigError
        Lists every unknown key with the nearest valid one, and every value
        that is of the wrong type or out of range with the limit and a remedy. What
        does not go together is listed once each value is right by itself.
    """
    rig, problems, of_file = config.get("rig", RIG), [], {}
    changes = {"name": rig} if isinstance(rig, str) else rig
    if isinstance(changes, Mapping):
        changes = dict(changes)
        name = str(changes.pop("name", RIG))
        try:
            of_file = {"fitted": {"name": name}} | read_yaml(rig_file(name))
        except ConfigError as error:
            problems.append(str(error))
    if changes:
        of_file |= {"fitted": {"name": "changed"}}
    if "fitted" in config:
        problems.append("fitted: is a part of a rig's file; put it into config/rigs, and name it")
    base = _merged(Settings().model_dump(), of_file)
    try:
        settings = Settings.model_validate(
            _merged(base, {**config, "rig": changes, "fitted": base["fitted"]})
        )
    except ValidationError as error:
        page = "docs/configuration.md"
        found = (explained(item, Settings, page) for item in error.errors())
        problems += dict.fromkeys("\n  ".join(found).split("\n  "))
    if problems:
        raise ConfigError.listing(problems, "configuration")
    return settings


def _merged(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """Return mappings merged key by key, as Snakemake merges its configuration files."""
    found = dict(below)
    for key, value in above.items():
        nested = isinstance(value, Mapping) and isinstance(below.get(key), Mapping)
        found[key] = _merged(below[key], value) if nested else value
    return found


def explained(item: Mapping[str, Any], section: type[BaseModel], page: str) -> str:
    """Return what is wrong, an error of pydantic on a section that ``page`` describes."""
    key = ".".join(map(str, item["loc"]))
    known = {name: default for name, default, *_ in fields(section)}
    kind = item["type"]
    if kind == "missing":
        return f"{key}: missing; see {page}"
    if kind == "extra_forbidden":
        return f"{key}: unknown key; {_nearest(key, known, page)}"
    message = item["msg"].removeprefix("Value error, ").replace("a valid tuple", "a list")
    message = re.sub("^(Input|String|Keys|Tuple) should", "must", message)
    if kind == "model_type":
        message = "must hold keys and values"
    # the messages of our checks name the value where that helps
    shown = "" if kind == "value_error" else f" = {item['input']}"
    # a default that is no value says nothing, and of the rig it is not what the chosen one has
    default = None if key.startswith("rig.") else known.get(key)
    remedy = "" if default in (None, {}, PydanticUndefined) else f" (default: {default!r})"
    place = f"{key}{shown}: " if key else ""
    return "\n  ".join(f"{place}{line.strip()}{remedy}" for line in message.splitlines())


def _nearest(key: str, known: Iterable[str], page: str) -> str:
    """Return the key that was probably meant, here or elsewhere, or those that there are."""
    *above, last = key.split(".")
    ways = [name.split(".") for name in known]
    depth = len(above)
    here = dict.fromkeys(way[depth] for way in ways if way[:depth] == above != way)
    near = get_close_matches(last, here, n=1) + [name for name in here if name.startswith(last)]
    likely = [way for way in ways if way[-1] == last] or [[*above, name] for name in near]
    if likely:
        return f"did you mean {'.'.join(likely[0])}?"
    return f"the keys are {in_words(here)}" if here else f"see {page}"


_HEAD = """\
# The paper's settings. Generated by `fprc config defaults`; change values here.
# docs/configuration.md explains the keys; `rig` names a fitted rig: `fprc config rig`.
"""

_PAGE = f"""\
# Configuration

Generated by `fprc config reference`. Every key can be set in `config/config.yaml`, in a file given
by `--configfile`, or by `--config`, merged key by key in this order; a list replaces a list, and a
key that a file repeats is an error. `fprc config check FILE ...` only checks.

`rig` is the name of a rig, as in `rig: viscous`, or its name and numbers that differ from it, as in
`rig: {{name: viscous, drift: {{time_s: 7}}}}`; without a name it is `{RIG}`. `fprc config rig NAME`
prints a rig of this package; your own are files `config/rigs/NAME.yaml`. What such a file leaves
out has the defaults below, which are not the values of `{RIG}`.

A key ends in the unit of its value, as `ki_v_per_kpa_s` in V/(kPa s); otherwise the unit is in
brackets behind the meaning, where `[-]` is none.
"""

_TABLE = ["| key | default | range | meaning | source |", "|" + "---|" * 5]


def defaults() -> str:
    """Return config/config.yaml: every setting but the rig's, at its default."""
    values = Settings().model_dump(mode="json", exclude={"rig", "fitted", "armed"})
    values = {"source": values.pop("source"), "rig": {"name": RIG}} | values
    return _HEAD + yaml.safe_dump(values, sort_keys=False, default_flow_style=None)


def reference() -> str:
    """Return docs/configuration.md: default, range, meaning and source of every key."""
    groups: dict[str, list[str]] = {}
    for key, default, field, section in fields(Settings):
        group, _, name = key.rpartition(".")
        head = ["", f"## {group or 'Top level'}", "", inspect.getdoc(section) or "", ""]
        groups.setdefault(group, head + _TABLE).append(_row(name, default, field))
    return _PAGE + "\n".join(sum(groups.values(), [])) + "\n"


def _row(name: str, default: Any, field: Any) -> str:
    ends, source = limit_of(field), (field.json_schema_extra or {}).get("source", "")
    limits = f"{ends.low:g} to {ends.high:g}" if ends else ""
    if get_origin(field.annotation) is Literal:
        limits = in_words(get_args(field.annotation), "or")
    return f"| `{name}` | `{json.dumps(default)}` | {limits} | {field.description} | {source} |"
