"""What is wrong with settings, in words: place, value, limit and remedy."""

import difflib
import re
from collections.abc import Iterable, Mapping
from typing import Any

from pydantic import BaseModel
from pydantic_core import PydanticUndefined

from fprc.config.section import fields
from fprc.escape import in_words


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
    message = re.sub("^(Input|String) should", "must", message)
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
    near = difflib.get_close_matches(last, siblings, n=1)
    near += [name for name in siblings if name.startswith(last)]
    likely = [way for way in ways if way[-1] == last] or [(*above, name) for name in near]
    if not likely:
        return f"the keys are {in_words(siblings)}" if siblings else f"see {page}"
    return f"did you mean {'.'.join(likely[0])}?"
