"""Every rule names an existing stage, and every stage is used by a rule."""

import ast
import re
from pathlib import Path

import pytest

import fprc
from fprc.stages.run import stage_of

PACKAGE = Path(fprc.__file__).parent
RULES = "".join(
    path.read_text(encoding="utf-8")
    for path in sorted((Path(__file__).parents[3] / "workflow").rglob("*.smk"))
)
NAMED = set(re.findall(r'\bstage="([^"]*)"', RULES))


def test_there_is_one_script():
    assert len(NAMED) > 30
    assert set(re.findall(r'"\.\./scripts/([^"]*)"', RULES)) == {"stage.py"}


@pytest.mark.parametrize("name", sorted(NAMED))
def test_stage_that_a_rule_names_is_a_function(name):
    assert callable(stage_of(name))


def place_of(path):
    return path.relative_to(PACKAGE).with_suffix("").parts


def test_every_public_function_is_the_stage_of_a_rule_or_has_a_use():
    """What no rule names and nothing calls is dead."""
    trees = {path: ast.parse(path.read_text(encoding="utf-8")) for path in PACKAGE.rglob("*.py")}
    nodes = [node for tree in trees.values() for node in ast.walk(tree)]
    used = {node.id for node in nodes if isinstance(node, ast.Name)}
    used |= {node.attr for node in nodes if isinstance(node, ast.Attribute)}
    idle = [
        name
        for path, tree in trees.items()
        if path.parent.name == "stages"
        for node in tree.body
        if isinstance(node, ast.FunctionDef)
        and not node.name.startswith("_")
        and node.name not in used
        and (name := ".".join([*place_of(path), node.name])) not in NAMED
    ]
    assert idle == ["stages.run.run_stage"]  # the one script calls it
