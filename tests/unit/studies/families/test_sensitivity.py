"""Sensitivity of the numbers to one parameter at a time."""

import copy
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from fprc.artifacts import read_json, write_json
from fprc.claims.finding import Results
from fprc.claims.paper import CLAIMS
from fprc.config import PUBLISHED, Settings
from fprc.errors import FprcError
from fprc.experiments.settings import RigSettings, Unit
from fprc.paper import CONTROLLERS, EXPERIMENTS, LOOPS, MODELS, REFERENCES
from fprc.plan.arguments import on_rig
from fprc.studies.families import sensitivity
from fprc.studies.stages import sensitivity as stage

SETTINGS = Settings().model_dump(mode="json")
PATHS = ["bending.stiffness_kpa_per_deg", "bending.inertia_kpa_s2_per_deg"]


GRIDS = {"epsilon": [1.0, 0.1, 0.01], "n_c": [1, 4], "n_u": [2, 5, 10], "n_y": [2, 5, 10]}
PHASES = {"train": "train_rmse_kpa", "test": "test_rmse_kpa"}


def judged_rig(error, tracking=1.0, seed=0):
    """Return what the surrogate returns: all errors alike, the other numbers drawn."""
    drawn = np.random.default_rng(seed).uniform(0.5, 2.0, 100).tolist()
    runs = [*REFERENCES, "disturbance"]
    return {
        "errors": {f"{log}/{model}/{phase}": error for log in EXPERIMENTS for model in MODELS
                   for phase in PHASES},
        "halves": {model: drawn.pop() for model in MODELS},
        "substitutes": {"sweep/fprc_lowpass": 2.0 * error, "sweep/bank": 4.0 * error,
                        "complex/fprc_lowpass": 5.0 * error, "sweep/ridge_p_o": 8.0 * error},
        "shares": {"p_o_over_theta_d": 0.5},
        "bias": drawn.pop(),
        "epsilon": [drawn.pop() for _ in GRIDS["epsilon"]],
        "n_c": {model: {phase: [drawn.pop() for _ in GRIDS["n_c"]] for phase in PHASES}
                for model in ("fprc", "fuzzy_linear")},
        "taps": [[drawn.pop() for _ in GRIDS["n_y"]] for _ in GRIDS["n_u"]],
        "control": {
            "rmse_deg": {f"{name}/{law}": tracking * (1 + (law == "pd")) for name in runs
                         for law in CONTROLLERS},
            "effort": {name: drawn.pop() for name in REFERENCES},
            "sweep": {name: drawn.pop() for name in
                      ("largest_error_deg", "lag_ms", "first_third_deg", "last_third_deg")},
            "loops": {f"{name}/{law}": {"width_over_span": drawn.pop()} for name in LOOPS
                      for law in CONTROLLERS},
            "disturbance": {name: drawn.pop() for name in ("bending", "p_o", "error_ratio")},
            "pressure_error": {name: drawn.pop() for name in ("main", "reservoir")},
        },
        "properties": dict.fromkeys(
            ("angle_deg", "loop_kpa", "loop_growth", "measured_loop_growth", "p_o_swing_kpa",
             "p_o_loop", "p_o_loop_growth", "p_o_swing_growth"), 7.0
        ),
    }  # fmt: skip


@pytest.fixture
def begun():
    """What the clusterings of each judged rig began at."""
    return []


@pytest.fixture
def by_stiffness(monkeypatch, begun):
    """Numbers that depend on the stiffness alone; the softest rig is impossible."""

    def judge(on_rig, seed, measures, centers, **how):
        stiffness = on_rig.rig["bending"]["stiffness_kpa_per_deg"]
        begun.append(dict(centers))
        centers.setdefault("readout", f"seed {seed}, {stiffness:g}")
        if stiffness < 2.1:
            raise FprcError("it diverged")
        return judged_rig(stiffness + seed, 1.0 / stiffness)

    monkeypatch.setattr(sensitivity, "judge_by_surrogate", judge)


@pytest.fixture
def effects(by_stiffness, tmp_path):
    path = tmp_path / "effects.json"
    write_json(path, {"source": "sim", "cells": judged_over(steps=3, seeds=[0, 2])})
    return str(path)


def judged_over(rig=SETTINGS["rig"], **how):
    """Move each parameter."""
    settings = RigSettings(**on_rig(SETTINGS) | {"rig": rig})
    units = [Unit(number, {}, [(settings, 1)]) for number in range(len(PATHS))]
    judged = [sensitivity.judge_parameter(unit, paths=PATHS, **how) for unit in units]
    return [cell for of_unit in judged for cell in of_unit]


def test_clusterings_of_every_rig_begin_at_those_of_the_rig_itself(effects, begun):
    own = SETTINGS["rig"]["bending"]["stiffness_kpa_per_deg"]
    assert begun[:2] == [{}, {}]
    where = [found["readout"] for found in begun if found]
    assert set(where) == {f"seed {seed}, {own:g}" for seed in (0, 2)}
    assert len(where) == 2 * 7 - 1  # the softest stops at its first seed
    assert [cell["path"] for cell in read_json(effects)["cells"]] == [
        None, *(path for path in PATHS for _ in range(3))
    ]  # fmt: skip


def test_changes_are_relative_to_the_rig_itself(effects, tmp_path):
    written = {end: str(tmp_path / f"table.{end}") for end in ("csv", "md")}
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


def results_of(judged):
    """Return result files with the numbers of a judged rig, as the claims read them."""

    def cell(model, errors, **settings):
        read = {name: [errors[phase]] for phase, name in PHASES.items() if phase in errors}
        return {"model": model, **settings, "validation_rmse_kpa": read["train_rmse_kpa"], **read}

    grids = {
        "epsilon": [
            cell("fprc", {"train": error}, epsilon=epsilon)
            for epsilon, error in zip(GRIDS["epsilon"], judged["epsilon"], strict=True)
        ],
        "n_c": [
            cell(model, {phase: errors[phase][i] for phase in PHASES}, n_c=n_c)
            for model, errors in judged["n_c"].items()
            for i, n_c in enumerate(GRIDS["n_c"])
        ],
        "taps": [
            cell("fprc", {"train": judged["taps"][i][j]}, n_u=n_u, n_y=n_y)
            for i, n_u in enumerate(GRIDS["n_u"])
            for j, n_y in enumerate(GRIDS["n_y"])
        ],
    }
    halves = [
        {"trained_on": "complex", "model": model, "test_halves_rmse_kpa": [1.0, ratio]}
        for model, ratio in judged["halves"].items()
    ]
    weights = {"mean_share": {"bias": judged["bias"], "p_o": 0.2, "theta_d": 0.4}}
    replicates = [{"models": halves, "weights": weights}]
    return Results(replicates, [grids], [judged["control"]], {}, {})


@pytest.mark.parametrize(
    ("group", "name", "claim", "of", "text"),
    [
        ("halves", "ESN", "C7d", max, "ESN"),
        ("halves", "FPRC", "C7d", max, "FPRC"),
        ("halves", "Fuzzy-linear", "C7d", max, "Fuzzy-linear"),
        ("bias", "share of the bias", "C8c", max, "%"),
        ("shares", "ratio of the shares", "C8b", max, ""),
        ("grids", "largest step over epsilon", "C9a", max, ""),
        ("grids", "largest step over n_c", "C9b", max, ""),
        ("grids", "FPRC / Fuzzy-linear, training", "C11", max, "training"),
        ("grids", "FPRC / Fuzzy-linear, test", "C11", max, "test"),
        ("grids", "few / medium n_u", "C12a", max, "training, few"),
        ("grids", "many / medium n_y", "C12b", max, "training, many"),
        ("control", "P_fb / P_ff", "C14", max, ""),
        ("control", "largest error", "C15", max, "largest"),
        ("control", "last / first third", "C15", max, "third"),
        ("control", "loop of PD", "C16", min, "loop of PD"),
        ("control", "loop, FPRC+PD / PD", "C16", max, "loop, FPRC"),
        ("control", "error, FPRC+PD / PD", "C16", max, "RMSE"),
        ("control", "bending, pushed", "C17", max, "bending"),
        ("control", "P_o, pushed", "C17", max, "change of P_o"),
        ("control", "error, pushed / not", "C17", max, "tracking"),
        ("pressure", "actuator", "C19", max, ""),
    ],
)
def test_number_of_a_claim_is_that_of_its_statement(group, name, claim, of, text):
    judged, published = judged_rig(1.0, seed=3), yaml.safe_load(PUBLISHED.read_text("utf-8"))
    (row,) = (row for row in CLAIMS if row.id == claim)
    found = [
        statement.values.item() / (100.0 if "%" in statement.text else 1.0)
        for statement in row.statements(results_of(judged), published)
        if text in statement.text
    ]
    assert sensitivity.NUMBERS[group, name](judged) == pytest.approx(of(found))


def test_ratio_to_a_substitute_is_fprcs_test_error_over_its(by_stiffness, effects):
    numbers = read_json(effects)["cells"][0]["numbers"]["substitutes"]
    assert list(numbers.values()) == pytest.approx([0.5, 0.25, 0.2, 0.125])


def test_page_has_the_change_with_its_sign_at_both_ends_and_what_is_unstable():
    def rows(share, change, closed_loop):
        values = dict.fromkeys(sensitivity.NUMBERS, (1.0, 0.0)) | {
            ("train", "II ESN"): (9.0, 0.5 * change),
            ("train", "II FPRC"): (9.0, change),
            ("open_loop", "Sweep"): (2.0, 0.0),
            ("closed_loop", "Sweep"): (closed_loop, closed_loop - 1.0),
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
    assert row["Other numbers of the closed loop (C14 to C17)"] == "unstable, +0 %"
    assert row["Pressure errors (C19)"] == "+0 %, +0 %"


def test_rig_that_cannot_be_simulated_itself_is_an_error(by_stiffness):
    soft = copy.deepcopy(SETTINGS["rig"])
    soft["bending"]["stiffness_kpa_per_deg"] = 2.0
    with pytest.raises(FprcError, match="it diverged"):
        judged_over(soft, steps=2, seeds=[0])
