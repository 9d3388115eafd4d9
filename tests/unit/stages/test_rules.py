"""What a rule does not name and nothing calls is dead; that each stage exists, dry runs show."""

import ast
import re
from pathlib import Path

import fprc

PACKAGE = Path(fprc.__file__).parent
RULES = "".join(
    path.read_text(encoding="utf-8")
    for path in (Path(__file__).parents[3] / "workflow").rglob("*.smk")
)


def test_every_public_function_is_the_stage_of_a_rule_or_has_a_use():
    trees = {path: ast.parse(path.read_text(encoding="utf-8")) for path in PACKAGE.rglob("*.py")}
    nodes = [node for tree in trees.values() for node in ast.walk(tree)]
    used = {node.id for node in nodes if isinstance(node, ast.Name)}
    used |= {node.attr for node in nodes if isinstance(node, ast.Attribute)}
    stages = {
        f"{path.stem}.{node.name}"
        for path, tree in trees.items()
        if path.parent.name == "stages"
        for node in tree.body
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_")
    }
    named = {".".join(name.split(".")[-2:]) for name in re.findall(r'\bstage="([^"]*)"', RULES)}
    idle = {name for name in stages - named if name.rpartition(".")[2] not in used}
    assert idle == {"run.run_stage"}  # the one script calls it
