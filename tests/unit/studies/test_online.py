from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fprc.artifacts import write_json
from fprc.config import Settings
from fprc.config.settings import Control, Feedforward, Tracking
from fprc.experiments.data import RigSettings
from fprc.experiments.tracking import Track
from fprc.models import FPRC
from fprc.paper import REFERENCES
from fprc.plan import on_rig
from fprc.studies import online as pages
from fprc.studies.family import Unit
from fprc.studies.learning import (
    CONDITIONS,
    OF_P_O,
    changed_rig,
    disturbed,
    followed,
    judge_online,
)

SETTINGS = Settings().model_dump(mode="json")


def shortened(duration_s):
    tracking = Settings().model_dump(mode="json")["tracking"]
    for described in tracking["references"].values():
        described |= {"duration_s": duration_s, "settle_s": 1.0}
    tracking["pushes"]["quiet_s"] = 1.5
    return tracking


@pytest.fixture(scope="module")
def judged():
    """What the judging of one short unit gives, as a frame."""
    signals = {name: spec | {"duration_s": 10.0} for name, spec in SETTINGS["experiments"].items()}
    rig = on_rig(SETTINGS) | {"signals": signals}
    unit = Unit(0, RigSettings(**rig), 5, every_model=False)
    found = judge_online(unit, tracking=shortened(3.0), models=SETTINGS["models"])
    return pd.DataFrame(found["rows"])


@pytest.mark.slow
def test_every_run_is_judged_once(judged):
    keys = ["model", "condition", "learns", "loop", "reference"]
    assert not judged.duplicated(keys).any()
    assert np.isfinite(judged["rmse_deg"]).all()
    counts = judged.groupby("model").size()
    every, few = len(CONDITIONS), len(CONDITIONS) - len(OF_P_O)
    references = len(REFERENCES)
    assert counts["fprc"] == 4 * every * references
    assert counts["fuzzy_linear"] == counts["fprc_lowpass"] == 4 * few * references
    assert counts["pd"] == few * references


def test_shift_of_p_o_moves_no_low_passed_angle():
    X = np.column_stack([30.0 * np.sin(np.arange(400) / 9.0), np.arange(400.0)])
    model = FPRC(n_c=2, random_state=1).fit(X, X[:, 0]).remember(X)
    rows = {}
    for shift in (0.0, -2.0):
        control = Control(feedforward=Feedforward(p_o_shift_kpa=shift))
        bench = Track(Tracking(**shortened(1.5)), control, SETTINGS["rig"], 1)
        rows[shift] = [followed(bench, "none", {name: model}) for name in ("fprc", "fprc_lowpass")]
    assert rows[0.0][1] == rows[-2.0][1]
    assert rows[0.0][0] != rows[-2.0][0]


@pytest.mark.slow
def test_conditions_change_what_they_name_and_nothing_else(judged):
    tidy = judged.set_index(["model", "condition", "learns", "loop", "reference"])["rmse_deg"]
    as_trained = tidy["fprc", :, False, "open", "sweep"]
    assert as_trained["none"] != as_trained["+5 kPa"] != as_trained["leak"]
    pd_alone = tidy["pd", :, False, "closed", "sweep"]
    assert pd_alone["none"] != pd_alone["stiffer"] != pd_alone["worn"]


def test_disturbances_of_p_o_are_those_of_physics():
    p_o, rate_hz = np.full(12_001, 20.0), 200.0
    assert (disturbed(p_o, "-2 kPa", rate_hz) == 18.0).all()
    leak = disturbed(p_o, "leak", rate_hz)
    assert (leak[0], leak[-1]) == (20.0, pytest.approx(16.0))
    warmer = disturbed(p_o, "warmer", rate_hz)
    # at constant volume, absolute pressure is proportional to absolute temperature
    assert warmer[0] == 20.0
    assert (warmer[-1] + 101.3) / (20.0 + 101.3) == pytest.approx(298.0 / 293.0)
    assert disturbed(p_o, "worn", rate_hz) is p_o
    rig, stiffer = SETTINGS["rig"], changed_rig(SETTINGS["rig"], "stiffer")
    key = "stiffness_kpa_per_deg"
    assert stiffer["bending"][key] == pytest.approx(1.1 * rig["bending"][key])
    assert changed_rig(rig, "leak") == rig


# --- verdicts ---------------------------------------------------------------------------------


def family(units=12, seed=1, **ratios):
    """Return a family of known errors: 1 deg, times the factor of a model or a condition."""
    rng, cells = np.random.default_rng(seed), []
    runs = [("fprc", c, learns, loop) for c in CONDITIONS
            for learns in (False, True) for loop in pages.LOOPS]  # fmt: skip
    runs += [("fprc_lowpass", "none", True, loop) for loop in pages.LOOPS]
    runs += [("fuzzy_linear", "none", learns, loop)
             for learns in (False, True) for loop in pages.LOOPS]  # fmt: skip
    runs += [("pd", "none", False, "closed")]
    for unit in range(units):
        rows = [
            {"model": model, "condition": condition, "learns": learns, "loop": loop,
             "reference": reference,
             "rmse_deg": ratios.get(condition if condition != "none" else model, 1.0)
             * float(np.exp(0.01 * rng.standard_normal()))}
            for model, condition, learns, loop in runs
            for reference in REFERENCES
        ]  # fmt: skip
        cells.append({"unit": unit, "seed": unit, "rows": rows})
    return {"source": "sim", "name": "dry", "fitted": [], "cells": cells}


@pytest.mark.parametrize(
    ("ratios", "verdicts"),
    [
        ({}, ["holds", "equivalent", "equivalent"]),
        ({"-5 kPa": 1.1}, ["undecided", "equivalent", "equivalent"]),
        ({"+5 kPa": 1.2}, ["does not hold", "equivalent", "equivalent"]),
        ({"fprc_lowpass": 1.3, "pd": 3.0}, ["holds", "superior", "superior"]),
        ({"fprc": 1.3}, ["holds", "inferior", "inferior"]),
    ],
)  # fmt: skip
def test_verdict_is_that_of_known_errors(ratios, verdicts):
    of = family(**ratios)
    found = pages.decided(of).groupby("id", sort=False)["words"].first()
    assert found.to_dict() == dict(zip(pages.CLAIMS, verdicts, strict=True))


@pytest.mark.slow
def test_verdicts_and_errors_are_tabulated_and_drawn(tmp_path):
    report = family()
    write_json(tmp_path / "dry.json", report)
    verdicts, errors, figure = (
        [str(tmp_path / f"{name}.{kind}") for kind in kinds]
        for name, kinds in (("v", ("csv", "md")), ("e", ("csv", "md")), ("f", ("pdf", "png")))
    )
    path = str(tmp_path / "dry.json")
    pages.tabulate_online([path], verdicts, errors, figure)
    for written in (*verdicts, *errors):
        assert "nan" not in Path(written).read_text(encoding="utf-8")
    assert Path(figure[1]).stat().st_size > 1000
    table = pd.read_csv(errors[0])
    chosen = table[(table["model"] == "fprc") & table["learns"] & (table["loop"] == "open")]
    keys = {"model": "fprc", "condition": "+2 kPa", "learns": True, "loop": "open"}
    overall = [
        np.sqrt(np.mean([x["rmse_deg"] ** 2 for x in cell["rows"] if keys.items() <= x.items()]))
        for cell in report["cells"]
    ]
    found = chosen.set_index("condition").loc["P_o +2 kPa", "mean_deg"]
    assert found == pytest.approx(np.mean(overall), rel=1e-5)
