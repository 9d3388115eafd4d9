"""Sensitivity of the numbers to one parameter at a time."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fprc.config import Settings
from fprc.errors import FprcError
from fprc.experiments.settings import RigSettings
from fprc.plan.arguments import on_rig
from fprc.studies.families import sensitivity
from fprc.studies.stages import sensitivity as stage

SETTINGS = Settings().model_dump(mode="json")
PATHS = ["bending.stiffness_kpa_per_deg", "bending.inertia_kpa_s2_per_deg"]


@pytest.fixture
def by_stiffness(monkeypatch):
    """Numbers that depend on the stiffness alone; the softest rig is impossible."""

    def judge(on_rig, seed, models, surrogate, grids, tracking, measures):
        bending = on_rig.rig["bending"]
        stiffness = bending["stiffness_kpa_per_deg"]
        if stiffness < 2.1:
            raise FprcError("it diverged")
        names = sensitivity.names_of_numbers()
        errors = {key: stiffness + seed for group, key in names if group in ("train", "test")}
        loops = {key: 7.0 for group, key in names if group == "loops"}
        runs = {
            group: {key: 1.0 / stiffness for found, key in names if found == group}
            for group in ("open_loop", "closed_loop")
        }
        return {"errors": errors, "properties": loops, "shares": 0.5, **runs}

    monkeypatch.setattr(sensitivity, "judge_by_surrogate", judge)


@pytest.fixture
def effects(by_stiffness, tmp_path):
    path = str(tmp_path / "effects.json")
    how = {"models": {}, "tracking": {}, "surrogate": {}}
    stage.measure_sensitivity(
        path, paths=PATHS, steps=3, seeds=[0, 2], on_rig=on_rig(SETTINGS), how=how, workers=1,
        checkpoint=str(tmp_path / "partial.jsonl"), version="1",
    )  # fmt: skip
    return path


def test_changes_are_relative_to_the_rig_itself(effects, tmp_path):
    written = {end: str(tmp_path / f"table.{end}") for end in ("csv", "md", "tex")}
    stage.tabulate_sensitivity(effects, **written)
    table = pd.read_csv(written["csv"])
    own, low, high = SETTINGS["rig"]["bending"]["stiffness_kpa_per_deg"], 2.0, 4.5
    softer = table[table["parameter"] == PATHS[0]]
    assert sorted(softer["share_of_range"].unique()) == [0.5, 1.0]  # the softest is impossible
    stiffest = softer[softer["share_of_range"] == 1.0].groupby("group")["change"].unique()
    assert stiffest["train"] == pytest.approx([(high + 1.0) / (own + 1.0) - 1.0], abs=1e-5)
    assert stiffest["closed_loop"] == pytest.approx([own / high - 1.0], abs=1e-5)
    assert stiffest["loops"] == pytest.approx([0.0])
    assert (table.loc[table["parameter"] == PATHS[1], "change"].abs() < 1e-12).all()
    page = Path(written["md"]).read_text(encoding="utf-8")
    lines = [line for line in page.splitlines() if line.startswith("| bend")]
    assert [line.split("|")[1].strip() for line in lines] == PATHS  # strongest first
    # the next value takes the place of the softest
    ends = [(value + 1.0) / (own + 1.0) - 1.0 for value in ((low + high) / 2, high)]
    shown = ", ".join(f"{100 * end:+.0f} %" for end in ends)
    assert lines[0].split("|")[2].strip() == shown


def test_page_has_the_change_with_its_sign_at_both_ends_and_what_is_unstable():
    def rows(share, change, closed_loop):
        values = {
            ("train", "II ESN"): (9.0, 0.5 * change),
            ("train", "II FPRC"): (9.0, change),
            ("open_loop", "Sweep"): (2.0, 0.0),
            ("closed_loop", "Sweep"): (closed_loop, closed_loop - 1.0),
            ("shares", "ratio of the shares"): (1.0, 0.0),
            ("test", "II ESN"): (9.0, 0.0),
            ("loops", "largest angle"): (60.0, 0.0),
        }
        return [
            {"parameter": "p", "share_of_range": share, "group": group, "number": number,
             "value": value, "change": relative}
            for (group, number), (value, relative) in values.items()
        ]  # fmt: skip

    table = pd.DataFrame([*rows(0.0, -0.2, 2.1), *rows(0.5, 5.0, 1.0), *rows(1.0, 0.1, 1.9)])
    (row,) = sensitivity.page_of_changes(table).to_dict("records")
    assert row["Training errors"] == "-20 %, +10 %"
    assert row["Closed loop"] == "unstable, +90 %"


def test_rig_that_cannot_be_simulated_itself_is_an_error():
    report = {"source": "sim", "cells": [{"path": None, "share": None, "numbers": None}]}
    with pytest.raises(FprcError, match="section rig"):
        sensitivity.changes(report)


@pytest.mark.slow
def test_every_number_of_the_surrogate_is_there(signals):
    settings = RigSettings(**on_rig(SETTINGS) | {"signals": signals})
    how = {"stride": 5, "esn_nodes": 20, "restarts": 1}
    numbers = sensitivity.judge_moved(
        {"path": None, "share": None}, seeds=[1], surrogate=how, on_rig=settings,
        models=SETTINGS["models"], tracking=SETTINGS["tracking"],
    )["numbers"]  # fmt: skip
    values = [value for group in numbers.values() for value in group.values()]
    assert len(values) == len(sensitivity.names_of_numbers()) == 12 + 8 + 1 + 7
    assert np.isfinite(values).all()
