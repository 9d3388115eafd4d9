import json
import shutil
from pathlib import Path

import pandas as pd
import pytest

from fprc.studies.stages.documents import update_tables
from fprc.studies.stages.show_beyond import draw_settings, tabulate_beyond
from fprc.tables.text import read_markdown

DOCS = Path(__file__).parents[4] / "docs"
CSV = ("models", "claims", "tracking", "offsets", "capacities", "lengths", "settings")
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
    parts = ("capacity", "training_length", "step_us")
    families = [make_family(spread=0.02), make_family("viscous", spread=0.02)]
    taken = [{name: family.pop(name) for name in parts} for family in families]
    written = {
        family["name"]: {
            "source": "sim",
            "families": {family["name"]: {key: family[key] for key in ("fitted", "unit")}},
            "cells": family["cells"],
        }
        for family in families
    }
    written |= {
        "capacity": {"cells": [{"family": "dry", **row} for row in taken[0]["capacity"]]},
        "training": {"cells": taken[0]["training_length"]},
        "steps": {"cells": [{"step_us": taken[0]["step_us"]}]},
        "settings": {"cells": SETTINGS},
    }
    for name, content in written.items():
        (tmp_path / f"{name}.json").write_text(json.dumps(content))
    path = {name: str(tmp_path / f"{name}.json") for name in (*written, "verdicts")}
    tables = {name: str(tmp_path / f"{name}.csv") for name in CSV}
    tabulate_beyond(
        [path["dry"], path["viscous"]],
        *(path[name] for name in ("capacity", "training", "steps", "settings", "verdicts")),
        [str(tmp_path / f"beyond/{name}.md") for name in PAGES], family="dry", **tables,
    )  # fmt: skip
    return path["verdicts"], tables


def test_what_was_measured_beside_the_models_belongs_to_its_family(tabulated):
    verdicts, tables = tabulated
    ledgers = json.loads(Path(verdicts).read_text())["ledgers"]
    judged = [{row["id"]: row["verdict"] for row in ledger} for ledger in ledgers]
    assert judged[0]["B8"] != "not judged"
    assert judged[1]["B8"] == "not judged"  # no capacity of that family
    families = {name: set(pd.read_csv(path)["world"]) for name, path in tables.items()}
    assert families["claims"] == families["models"] == {"dry", "viscous"}
    assert families["lengths"] == families["capacities"] == {"dry"}


def test_page_and_leaderboard_have_the_numbers_of_the_tables(tabulated, tmp_path):
    verdicts, tables = tabulated
    page, details, board = (
        shutil.copy(DOCS / name, tmp_path)
        for name in ("beyond.md", "beyond-details.md", "benchmark.md")
    )
    (tmp_path / "figure.png").write_bytes(b"picture")
    given = [str(Path(verdicts).with_name("beyond") / f"{name}.md") for name in PAGES]
    for _ in range(2):  # the blocks stay where they are
        update_tables(
            given, [str(tmp_path / "figure.png")], pages=[page, board, details],
            pictures=[str(tmp_path / "picture.png")],
        )  # fmt: skip
    assert (tmp_path / "picture.png").read_bytes() == b"picture"
    text = Path(board).read_text(encoding="utf-8")
    block = text.split("<!-- beyond_leaderboard: generated -->\n")[1]
    _, leaders = read_markdown(block.split("<!-- beyond_leaderboard: end -->")[0])
    table = pd.read_csv(tables["models"])
    forward = table[(table["world"] == "dry") & (table["measure"] == "forward")]
    best = forward[~forward["model"].str.endswith(("_oracle", "_matched"))]["mean"].min()
    column = next(name for name in leaders if "Forward" in name)
    assert leaders[column].iloc[0].startswith(f"{best:.3g}"[:3])
    shown = [float(text.split()[0]) for text in leaders[column]]
    assert shown == sorted(shown)


def test_ratio_over_a_setting_is_a_geometric_mean(tabulated, tmp_path):
    path = tabulated[1]["settings"]
    table = pd.read_csv(path).set_index(["setting", "value"])
    assert table.loc["epsilon", 0.01]["mean"].item() == pytest.approx(0.8 ** (2 / 3))
    assert (table["units"] == 3).all()
    flat = table.drop(("epsilon", 0.01))
    assert flat[["mean", "low", "high"]].to_numpy() == pytest.approx(1.0)
    pdf, png = (str(tmp_path / f"settings.{kind}") for kind in ("pdf", "png"))
    assert draw_settings(path, pdf, png)["source"] == "sim"
    assert Path(png).stat().st_size > 1000
