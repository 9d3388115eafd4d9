import json
from pathlib import Path

import pandas as pd
import pytest

from fprc.studies.stages.show_beyond import draw_beyond, tabulate_beyond

CSV = ("models", "claims", "offsets", "capacities", "settings")
PAGES = (*CSV[:-1], "worlds", "beside", "fitted", "details", "leaderboard")


#: FPRC is 20 % better with P_o at epsilon 0.01, on every seed but one.
SETTINGS = [
    {"family": "dry", "unit": unit, "setting": setting, "value": value, "fprc": ours,
     "fprc_lowpass": 10.0}
    for setting, values in (("epsilon", (0.001, 0.01)), ("n_c", (2, 4)))
    for value in values
    for unit, ours in enumerate((8.0, 8.0, 10.0) if value == 0.01 else (10.0,) * 3)
]  # fmt: skip


@pytest.fixture(scope="module")
def tabulated(make_family, tmp_path_factory):
    """Tables of two families; a file for each part of the first one, as the workflow has them."""
    tmp_path = tmp_path_factory.mktemp("beyond")
    families = [make_family(spread=0.02), make_family("viscous", spread=0.02)]
    taken = [family.pop("capacity") for family in families]
    written = {
        family["name"]: {
            "source": "sim",
            "families": {family["name"]: {key: family[key] for key in ("fitted", "unit")}},
            "cells": family["cells"],
        }
        for family in families
    }
    written |= {
        "capacity": {"cells": [{"family": "dry", **row} for row in taken[0]]},
        "settings": {"cells": SETTINGS},
    }
    for name, content in written.items():
        (tmp_path / f"{name}.json").write_text(json.dumps(content))
    path = {name: str(tmp_path / f"{name}.json") for name in written}
    tables = {name: str(tmp_path / f"{name}.csv") for name in CSV}
    tabulate_beyond(
        [path["dry"], path["viscous"]],
        *(path[name] for name in ("capacity", "settings")),
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
@pytest.mark.parametrize("figure", ["pairs", "offsets", "capacities", "settings"])
def test_figure_is_drawn_from_its_table(tabulated, tmp_path, figure):
    table = tabulated["claims" if figure == "pairs" else figure]
    pdf, png = (str(tmp_path / f"{figure}.{kind}") for kind in ("pdf", "png"))
    data = draw_beyond(table, pdf, png, figure=figure, family="dry")
    assert data["source"] == "sim"
    assert Path(png).stat().st_size > 1000


def test_ratio_over_a_setting_is_a_geometric_mean(tabulated):
    table = pd.read_csv(tabulated["settings"]).set_index(["setting", "value"])
    assert table.loc["epsilon", 0.01]["mean"].item() == pytest.approx(0.8 ** (2 / 3))
    assert (table["units"] == 3).all()
    flat = table.drop(("epsilon", 0.01))
    assert flat[["mean", "low", "high"]].to_numpy() == pytest.approx(1.0)
