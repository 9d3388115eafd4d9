import json
from pathlib import Path

import pandas as pd
import pytest

from fprc.studies.stages.show_beyond import draw_beyond, tabulate_beyond

CSV = ("models", "claims", "offsets", "capacities")
PAGES = (*CSV, "beside", "fitted", "details", "leaderboard")


@pytest.fixture(scope="module")
def tabulated(make_family, tmp_path_factory):
    """Tables of two families; a file for each part of the first one, as the workflow has them."""
    tmp_path = tmp_path_factory.mktemp("beyond")
    families = [make_family(spread=0.02), make_family("viscous", spread=0.02)]
    taken = [family.pop("capacity") for family in families]
    written = {
        family["name"]: {
            "source": "sim",
            "families": {family["name"]: {key: family[key] for key in ["fitted"]}},
            "cells": family["cells"],
        }
        for family in families
    }
    written |= {
        "capacity": {"cells": [{"family": "dry", **row} for row in taken[0]]},
    }
    for name, content in written.items():
        (tmp_path / f"{name}.json").write_text(json.dumps(content))
    path = {name: str(tmp_path / f"{name}.json") for name in written}
    tables = {name: str(tmp_path / f"{name}.csv") for name in CSV}
    tabulate_beyond(
        [path["dry"], path["viscous"]],
        path["capacity"],
        [str(tmp_path / f"beyond/{name}.md") for name in PAGES], family="dry", **tables,
    )  # fmt: skip
    return tables


def test_what_was_measured_beside_the_models_belongs_to_its_family(tabulated):
    claims = pd.read_csv(tabulated["claims"]).set_index(["world", "id"])[["verdict"]]
    assert "not judged" not in set(claims.loc[[("dry", "B8")], "verdict"])
    assert set(claims.loc[[("viscous", "B8")], "verdict"]) == {
        "not judged"
    }  # no capacity of that family
    families = {name: set(pd.read_csv(path)["world"]) for name, path in tabulated.items()}
    assert families["claims"] == families["models"] == {"dry", "viscous"}
    assert families["capacities"] == {"dry"}
    written = Path(tabulated["claims"]).with_name("beyond").glob("*.md")
    assert {path.stem for path in written} == set(PAGES)


@pytest.mark.slow
@pytest.mark.parametrize("figure", ["pairs", "offsets", "capacities"])
def test_figure_is_drawn_from_its_table(tabulated, tmp_path, figure):
    table = tabulated["claims" if figure == "pairs" else figure]
    pdf, png = (str(tmp_path / f"{figure}.{kind}") for kind in ("pdf", "png"))
    data = draw_beyond(table, pdf, png, figure=figure, family="dry")
    assert data["source"] == "sim"
    assert Path(png).stat().st_size > 1000
