"""Every command and every Python block of README and docs: it exists, or a test runs it."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from fprc.commands.parser import parser
from fprc.config import Settings

ROOT = Path(__file__).parents[2]
PAGES = ["README.md", "CONTRIBUTING.md", "data/raw/README.md",
         *sorted(
    str(path.relative_to(ROOT)) for path in (ROOT / "docs").glob("*.md")
)]  # fmt: skip
PROGRAMS = "fprc|make|snakemake"

#: For each Python block of a page: the test that runs it, or why none does.
BLOCKS = {
    "README.md": ["tests/unit/test_datasets.py"],
    "data/raw/README.md": ["tests/unit/logs/test_columns.py"],
    "docs/extending.md": [
        "tests/workflow/test_extending.py",
        "tests/unit/models/test_compose.py",
        "tests/unit/models/test_compose.py",
    ],
    "docs/changing.md": ["a protocol without bodies"],
    "docs/elsewhere.md": ["tests/workflow/test_module.py"],
}
#: Targets of other Snakefiles than ours, and the tests that make them.
TARGETS_ELSEWHERE = {
    "mine": "tests/workflow/test_extending.py",
    "paper_all": "tests/workflow/test_module.py",
}


def commands_of(page):
    """Return the commands of a page: those on separate lines, and those within a sentence."""
    text = re.sub(r" *\\\n *", " ", (ROOT / page).read_text("utf-8"))
    whole = re.findall(rf"^(?:\$ | {{4,}})((?:{PROGRAMS}) .*)$", text, flags=re.MULTILINE)
    inline = re.findall(rf"`(?:FPRC_\w+=\w+ )?((?:{PROGRAMS}) [^`]+)`", text)
    return list(map(words, whole)), list(map(words, inline))


def words(command):
    """Return the words of a command as the shell sees them, without a redirection."""
    return shlex.split(re.sub(r" > .*", "", command), comments=True)


EVERY = [
    pytest.param(command, whole, id=f"{page}: {' '.join(command)[:60]}")
    for page in PAGES
    for whole, found in zip((True, False), commands_of(page), strict=True)
    for command in found
]


def of(program):
    return [case for case in EVERY if case.values[0][0] == program]


@pytest.mark.parametrize(("command", "whole"), of("fprc"))
def test_command_of_fprc_is_one_that_its_parser_takes(command, whole):
    given = [word for word in command[1:] if word != "..."]
    if whole:
        assert callable(parser().parse_args(given).run)
        return
    here = parser()
    for word in given:
        if word.startswith("-"):
            assert word in here._option_string_actions
            continue
        groups = [action for action in here._actions if isinstance(action.choices, dict)]
        if groups and not word.isupper():
            assert word in groups[0].choices
            here = groups[0].choices[word]


@pytest.mark.parametrize(("command", "whole"), of("make"))
def test_target_of_make_exists(command, whole):
    text = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = set(" ".join(re.findall(r"^([\w./ -]+):(?!=)", text, flags=re.MULTILINE)).split())
    assert {word for word in command[1:] if "=" not in word} <= targets


@pytest.mark.slow
def test_targets_options_and_keys_of_snakemake_exist():
    from snakemake.cli import get_argument_parser

    done = subprocess.run(
        [sys.executable, "-m", "snakemake", "--list-rules", "--snakefile",
         "workflow/studies/Snakefile"],
        cwd=ROOT, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    rules = set(done.stdout.split())
    assert "table2" in rules
    for command, _ in (case.values for case in of("snakemake")):
        given = [word for word in command[1:] if word != "..."]
        options = get_argument_parser().parse_args(given)
        unknown = set(options.targets or ()) - rules - TARGETS_ELSEWHERE.keys()
        assert not unknown, command
        keys = {pair.partition("=")[0] for pair in options.config or ()}
        assert keys <= Settings.model_fields.keys(), command


@pytest.mark.parametrize("page", PAGES)
def test_python_of_a_page_is_run_by_a_test_or_listed(page):
    blocks = re.findall(r"^ *```python", (ROOT / page).read_text("utf-8"), flags=re.MULTILINE)
    assert len(blocks) == len(BLOCKS.get(page, []))
    for test in filter(re.compile("tests/").match, BLOCKS.get(page, [])):
        assert Path(page).name in (ROOT / test).read_text("utf-8")
