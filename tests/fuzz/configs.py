"""Configurations: settings written as YAML and then damaged or made odd."""

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import damage
import numpy as np
import reading
import yaml
from judging import SAME, SILENT, Case, Ended, Step, Verdict

from fprc.config import Settings, from_files
from fprc.config.section import fields

NAME = "mine.yaml"

#: A word before a colon. Matches start only at a word's start: words may have a million letters.
_KEY = re.compile(r"""(?<![^\s:{},'"\[\]])([^\s:{},'"\[\]]+) ?['"]?\s*:""")

#: Keys that YAML does not read as text, as a message shows them.
_AS_READ = {"true": "True", "false": "False", "null": "None"}

#: Odd values, as YAML text.
_ODD = (
    "010", "1:30", "0o17", "0x10", "1_000", "1e3", "1e-06", "+5", "-0", ".5", "5.", '"7"', "'1e3'",
    ".nan", ".inf", "-.inf", "1e400", "1e308", "-1e308", "1" * 5000, "1" + "0" * 30, "0.1.2", "1,5",
    "1 000", "½", "true", "yes", "on", "no", "null", "~", "", "2020-01-01", "12:30:45",
    "[]", "{}", "[1, 2]", "{a: 1}", "[[1]]", "{1: 2}", "? ", "!!python/object/apply:os.system [ls]",
    "!!binary aGFsbG8=", "!!set {a}", "!foo bar", "!!int '3'", "!!float x", "*nothing", "&a 5",
    "&a [*a]", "'\\x1b[31m'", '"\\e[31mred"', '"\\0"', "|\n    text\n", ">\n  5\n", "# nothing",
    "@x", "`x`", "%x", "- 5", "sim", "FPRC", "{{x}}", "${HOME}", "=1+1", "nan", "inf", "Infinity",
)  # fmt: skip

#: Forbidden folders of results; a pair is (raw, results).
_NOT_THERE = (
    "/", "src", "./src", "src/", "src/fprc", ".git", ".git/hooks", "config", "config/maps",
    "workflow", ".", "a\0b", "{experiment}", "a{b", "}", "x" * 300, "a\nb", "a\rb",
    "results/../src", ("mine", "mine"), ("mine", "./mine"), ("mine", "mine/"),
    ("data/raw", "data/../data/raw"),
)  # fmt: skip
_THERE = ("data/mine", "results/mine", "/tmp/mine", "my results", "größe", ("a/raw", "a"))


def _defaults() -> dict[str, Any]:
    """Return the default settings; not cached, because a case may change them."""
    return Settings().model_dump(mode="json")


@cache
def _leaves() -> list[str]:
    return [name for name, *_ in fields(Settings())]


def case(rng: np.random.Generator, folder: Path) -> Case:
    """Make a case of a configuration."""
    way, weight = list(_WAYS), np.array(list(_WAYS.values()), float)
    make = way[rng.choice(len(way), p=weight / weight.sum())]
    data, change, wrong = make(rng)
    (folder / NAME).write_bytes(data)
    if make is _folders:  # the project's own folders exist
        for name in ("src/fprc", ".git/hooks", "config/maps", "workflow", "data/raw"):
            (folder / name).mkdir(parents=True)

    def checked(folder: Path, ended: Ended) -> Verdict:
        return compare(folder, wrong)

    step = Step(("config", "check", NAME), "fprc config check", _names(data), checked)
    return Case("configuration", change, [step])


def compare(folder: Path, wrong: str) -> Verdict:
    """Compare the accepted settings with the text of the file."""
    if wrong:
        return SILENT, wrong
    try:
        said = reading.read((folder / NAME).read_bytes())
    except reading.UnclearError as error:
        return SILENT, f"accepted without a unique meaning: {str(error)[:200]}"
    got = from_files([folder / NAME]).model_dump(mode="json")
    defaults = from_files([]).model_dump(mode="json")
    if {"rig", "fitted"} <= said.keys():  # a whole rig
        defaults["rig"] = _defaults()["rig"]
    if "rig" in said and "fitted" not in said:
        # a rig of numbers is not a fitted one
        del got["fitted"]
    other = reading.differing(got, said, defaults)
    return (SILENT, "; ".join(other)[:500]) if other else (SAME, "")


def _names(data: bytes) -> tuple[str, ...]:
    """Return the names of which a refusal must contain one: the file, or a key of it."""
    text = data.decode("utf-8", "replace")
    keys = set(_KEY.findall(text))
    keys |= {_AS_READ[key] for key in keys & _AS_READ.keys()}
    # many words contain "a"; " a:" is unambiguous
    short = [f" {key}{mark}" for key in keys for mark in (":", " =") if len(key) < 3]
    return (NAME, *sorted(key for key in keys if len(key) > 2), *sorted(short))


def _some(rng: np.random.Generator, placeholders: int = 0) -> dict[str, Any]:
    """Return random settings, nested; the values of the first are placeholders."""
    names = rng.permutation(_leaves())[: int(rng.integers(1, 12))]
    tree: dict[str, Any] = {}
    defaults = _defaults()
    for k, name in enumerate(names):
        value: Any = defaults
        for part in name.split("."):
            value = value[part]
        if isinstance(value, float) and rng.random() < 0.5:
            value *= 0.99
        *way, last = name.split(".")
        inner = tree
        for part in way:
            inner = inner.setdefault(part, {})
        inner[last] = f"@{k}@" if k < placeholders else value
    return tree


def _dump(rng: np.random.Generator, tree: dict[str, Any]) -> str:
    flow = [False, None, True][rng.choice(3, p=[0.6, 0.2, 0.2])]
    text = yaml.safe_dump(tree, default_flow_style=flow, allow_unicode=True, width=10000)
    return f"# mine\n{text}" if rng.random() < 0.3 else text


# Each function returns the file, a description, and, if the text does not show it, why it must be
# refused.


def _whole(rng):
    return _dump(rng, _some(rng)).encode(), "unchanged", ""


def _odd_value(rng):
    text, values = _dump(rng, _some(rng, 2)), []
    for mark in ("'@0@'", "'@1@'"):
        value = str(rng.choice(_ODD))
        text = text.replace(mark, value)
        values.append(value[:40])
    return text.encode(), f"values {' and '.join(values)}", ""


def _twice(rng):
    text = yaml.safe_dump(_some(rng), default_flow_style=False)
    lines = text.splitlines()
    k = int(rng.integers(len(lines)))
    key = re.match(r"( *[\w-]+):", lines[k])
    if key is None:
        return _whole(rng)
    if rng.random() < 0.5:
        again = f"{key[1]}: {rng.choice(['3', '{}', '[1]', 'null', 'x'])}"
        lines.insert(k, again)
    else:  # a whole section, or value, once more at the end
        begin = max(j for j in range(k + 1) if not lines[j].startswith((" ", "-")))
        lines += lines[begin : k + 1]
    return "\n".join(lines).encode(), f"{key[1].strip()} twice", ""


def _unknown(rng):
    tree = _some(rng)
    key = [
        "modles", "Seed", "models.fprc", 1, 1.5, None, True, "", "\x1b[31m", "a b", "ünknown",
        "x" * 3000, "seed ", "__class__", "model_config",
    ][rng.integers(15)]  # fmt: skip
    inner = tree
    while rng.random() < 0.6 and any(isinstance(v, dict) for v in inner.values()):
        inner = next(v for v in inner.values() if isinstance(v, dict))
    inner[key] = [1, "x", {"a": 1}, None][rng.integers(4)]
    return _dump(rng, tree).encode(), f"unknown key {str(key)[:30]!r}", ""


def _flipped(rng):
    data = _dump(rng, _some(rng)).encode()
    return (*damage.flip(rng, data), "")


def _torn(rng):
    data = _dump(rng, _some(rng)).encode()
    return (*damage.ROUGH[rng.integers(len(damage.ROUGH))](rng, data), "")


def _nested(rng):
    depth = int(rng.choice([20, 300, 5000, 100000]))
    key = str(rng.choice(["seed", "models", "folders", "calibration"]))
    made = [
        f"{key}: {'[' * depth}{']' * depth}", f"{key}: {'{a: ' * depth}1{'}' * depth}",
        "\n".join(f"{' ' * k}a:" for k in range(min(depth, 2000))), f"{key}: {'- ' * depth}1",
    ]  # fmt: skip
    return made[rng.integers(len(made))].encode(), f"{depth} deep", ""


def _aliases(rng):
    made = [
        "seed: &a 5\ncontrol: {sample_rate_hz: 100}\nmodels: {n_y: *a}\n",
        "models: &m\n  n_y: 3\n  fprc: *m\n",
        "a: &a [x, x, x, x, x, x, x, x, x]\n"
        + "".join(
            f"{chr(98 + k)}: &{chr(98 + k)} [{', '.join(['*' + chr(97 + k)] * 9)}]\n"
            for k in range(9)
        ),
        "models: &m {n_y: 3}\nx: {<<: *m}\n",
        "experiments: {sweep: &s {duration_s: 50}, complex: {<<: *s, duration_s: 60}}\n",
        "grids: {epsilon: &e [0.1, 0.2], n_c: [1, 2]}\ncalibration: {ranges: *e}\n",
        "seed: *b\n",
        "&x seed: 5\n",
    ]
    k = int(rng.integers(len(made)))
    return made[k].encode(), f"aliases, {k}", ""


def _file(rng):
    made = [
        b"", b"\n\n", b"# nothing\n", b"5", b"[1, 2]", b"seed", b"a: 1\n---\nb: 2\n",
        b"--- {}\n...\n", b"\xff\xfes\0e\0e\0d\0:\0 \x005\0", b"\xef\xbb\xbfseed: 5\n",
        b"seed: 5\r\nsource: sim\r\n", b"seed: 5\rsource: sim", b"seed:\t5", b"\tseed: 5",
        b"gr\xf6\xdfe: 5", b"seed: 5 # gr\xf6\xdfe", b"\0", b"seed: 5\0", b"{seed: 5", b"seed: 5}",
        b"%YAML 1.1\n---\nseed: 5\n", b"%YAML 2.0\n---\nseed: 5\n", b"seed: 5\n" + b" " * 10**6,
        b"# " + b"x" * 10**6 + b"\nseed: 5",
        b"x: " + b"y" * 10**6, b"\x1b[31mseed: 5", b"PK\x03\x04" + bytes(100), b"seed: \xc2\x9b5",
    ]  # fmt: skip
    k = int(rng.integers(len(made)))
    return made[k], f"file {k}: {made[k][:30]!r}", ""


def _folders(rng):
    bad = rng.random() < 0.8
    names = _NOT_THERE if bad else _THERE
    chosen = names[rng.integers(len(names))]
    if isinstance(chosen, tuple):
        folders = dict(zip(("raw", "results"), chosen, strict=True))
    else:
        folders = {str(rng.choice(["raw", "results"])): chosen}
    if rng.random() < 0.3:
        folders |= {"results": "results/mine"} if "results" not in folders else {}
    text = json.dumps({"folders": folders})
    return text.encode(), f"folders {text[:100]}", f"accepted {text[:100]}" if bad else ""


_WAYS = {
    _whole: 1, _odd_value: 6, _twice: 3, _unknown: 3, _flipped: 4, _torn: 3, _nested: 0.3,
    _aliases: 0.7, _file: 1.5, _folders: 2,
}  # fmt: skip
