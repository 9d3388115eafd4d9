"""Errors at the stop of the actuator, and off it."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fprc.config import Settings
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import Judgement, RigSettings, Unit
from fprc.plan.arguments import on_rig
from fprc.registry import build
from fprc.studies.families import stop
from fprc.studies.stages import sensitivity as stage

SETTINGS = Settings().model_dump(mode="json")


@pytest.fixture(scope="module")
def judged(signals):
    models = SETTINGS["models"] | {"n_y": 2}
    models["esn"] |= {"r": 12, "washout": 10}
    models["fprc"] |= {"n_c": 2, "n_u": 2}
    rig = RigSettings(**on_rig(SETTINGS) | {"signals": signals})
    judgement = {"models": models, "folds": 2, "split": "shuffled"}
    (found,) = stop.judge_stop(Unit(3, {}, [(rig, 3)]), judgement=judgement)
    return found, simulate(rig, 3)["sweep"].channels, (rig, Judgement(**judgement, seed=3))


def test_parts_make_the_whole_and_share_is_theirs(judged):
    found, log, _ = judged
    f = found["at_stop"]
    assert f == pytest.approx(np.mean(log["theta_deg"] < 0.5))
    assert 0.0 < f < 1.0
    for name in ("esn", "fprc", "fuzzy_linear"):
        own = found[name]
        at, off = f * own["at"] ** 2, (1.0 - f) * own["off"] ** 2
        assert own["share"] == pytest.approx(at / (at + off))


def test_least_squares_without_the_stop_is_no_worse_off_it(judged):
    own = judged[0]["esn"]  # a linear readout; those of the fuzzy models cluster anew
    assert own["without_off"] <= own["off"] * (1.0 + 1e-6)
    assert own["without_test"] != own["test"]


def test_reversed_error_is_that_of_a_model_of_the_other_log(judged):
    found, _, (rig, how) = judged
    logs = simulate(rig, 3)
    model = build("fprc", how.models, 3).fit(*logs["complex"].pair("fprc"))
    X, y = logs["sweep"].pair("fprc")
    assert found["fprc"]["reversed"] == pytest.approx(np.sqrt(np.mean((model.predict(X) - y) ** 2)))


def test_table_has_a_row_per_rig_and_model(judged, tmp_path):
    rigs = {"a": {}, "a, no drift": {}}
    cells = [{**judged[0], "seed": seed, "family": rig} for rig in rigs for seed in (1, 2, 3)]
    report = pd.Series({"source": "sim", "families": rigs, "cells": cells}).to_json()
    (tmp_path / "stop.json").write_text(report)
    files = {end: str(tmp_path / f"stop.{end}") for end in ("csv", "md")}
    stage.tabulate_stop(str(tmp_path / "stop.json"), **files)
    table = pd.read_csv(files["csv"]).set_index(["rig", "model", "number"])
    assert table.loc[("a, no drift", "fprc", "share"), "mean"] == pytest.approx(
        100 * judged[0]["fprc"]["share"]
    )
    assert table["low"].to_numpy() == pytest.approx(table["mean"].to_numpy())
    assert Path(files["md"]).read_text(encoding="utf-8").count("| ESN ") == 2
