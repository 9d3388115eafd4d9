import json
import re
from pathlib import Path

import pandas as pd
import pytest

from fprc.studies.stages import beyond as stage

CSV = ("models", "claims", "offsets")
PAGES = (*CSV, "best", "memory", "fitted", "details", "leaderboard", "worth")


@pytest.fixture(scope="module")
def tabulated(make_family, tmp_path_factory):
    """Tables of two families; a file for each part of the first one, as the workflow has them."""
    tmp_path = tmp_path_factory.mktemp("beyond")
    families = [make_family(spread=0.02), make_family("viscous", spread=0.02)]
    path = {family["name"]: str(tmp_path / f"{family['name']}.json") for family in families}
    for family in families:
        Path(path[family["name"]]).write_text(json.dumps({"source": "sim", **family}))
    tables = {name: str(tmp_path / f"{name}.csv") for name in CSV}
    stage.tabulate_beyond(
        [path["dry"], path["viscous"]],
        [str(tmp_path / f"beyond/{name}.md") for name in PAGES], family="dry", **tables,
    )  # fmt: skip
    return tables


def test_every_table_has_every_family_and_every_page_is_written(tabulated):
    claims = pd.read_csv(tabulated["claims"])
    assert "not judged" not in set(claims["verdict"])
    families = {name: set(pd.read_csv(path)["world"]) for name, path in tabulated.items()}
    assert families["claims"] == families["models"] == {"dry", "viscous"}
    written = Path(tabulated["claims"]).with_name("beyond").glob("*.md")
    assert {path.stem for path in written} == set(PAGES)


def test_pages_are_the_blocks_of_the_documentation():
    docs = Path(__file__).parents[4] / "docs"
    begun = {
        name
        for page in ("../README.md", "beyond.md", "beyond-details.md", "benchmark.md")
        for name in re.findall(r"<!-- (\w+): generated -->", (docs / page).read_text("utf-8"))
    }
    of_paper = {name for name in begun if not name.startswith("beyond_")}
    assert {f"beyond_{name}" for name in PAGES} == begun - of_paper


@pytest.mark.slow
def test_figure_is_drawn_from_its_table(tabulated, tmp_path):
    pdf, png = (str(tmp_path / f"pairs.{kind}") for kind in ("pdf", "png"))
    stage.draw_pairs(tabulated["claims"], pdf, png)
    assert Path(png).stat().st_size > 1000
