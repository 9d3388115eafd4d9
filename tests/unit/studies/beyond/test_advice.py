"""Sentences that follow from verdicts and numbers."""

import re

import numpy as np
import pytest

from fprc.studies.beyond.advice import advice
from fprc.studies.beyond.claims import CLAIMS, judge_world

TITLES = {"fprc": "FPRC", "fprc_lowpass": "Low-pass", "bank": "Bank", "fuzzy_linear": "Fuzzy"}
VERDICTS = {
    "superior": "lowers {what} by 50 % on the A rig, by 50 % on the B rig.",
    "equivalent": "lowers {what} by 50 % on the A rig; on the B rig it changes by less than 5 %.",
    "inferior": "lowers {what} by 50 % on the A rig and raises it by 150 % on the B rig.",
    "undecided": "lowers {what} by 50 % on the A rig; on the B rig the difference is undecided.",
    "not judged": "lowers {what} by 50 % on the A rig; on the B rig it was not measured.",
}


def ledger(title, unit="seed", **verdicts):
    """Return a ledger in which FPRC has half the error, or 2.5 times where it is inferior."""
    rows = []
    for name in CLAIMS:
        verdict = verdicts.get(name, "superior")
        parts = [{"mean": 2.5 if verdict == "inferior" else 0.5}]
        rows.append({"id": name, "title": title, "unit": unit, "verdict": verdict,
                     "parts": [] if verdict == "not judged" else parts})  # fmt: skip
    return rows


def said(*ledgers):
    worlds = [{"name": own[0]["title"], "cells": []} for own in ledgers]
    return advice(worlds, ledgers, TITLES)


def advised(world):
    return advice([world], [judge_world(world, TITLES)], TITLES)


@pytest.mark.parametrize("verdict", VERDICTS)
@pytest.mark.parametrize(
    ("claim", "what"),
    [("B1", "FPRC's forward test error"), ("B3", "FPRC's tracking error in open and closed loop")],
)
def test_every_verdict_is_said_with_its_rig(verdict, claim, what):
    first = said(ledger("A"), ledger("B", **{claim: verdict}))[0]
    assert VERDICTS[verdict].format(what=what) in first


def test_several_rigs_of_the_last_verdict_are_the_others():
    ledgers = [ledger(name, "rig", B1="undecided", B7="undecided") for name in "BC"]
    points = said(ledger("A"), *ledgers)
    assert "; on the others the difference is undecided." in points[0]
    assert points[4].endswith("lower on the A rig, undecided on the others.")
    points = said(*ledgers)
    assert "is not shown to change FPRC's forward test error; on all these rigs" in points[0]


def test_a_part_against_the_verdict_keeps_its_sign():
    ours = ledger("A", B3="inferior")
    ours[2]["parts"] = [{"mean": 1.27}, {"mean": 0.98}]
    assert "raises FPRC's tracking error in open and closed loop by 27 % and -2 %" in said(ours)[0]


def test_reservoir_pays_where_all_errors_fall():
    harmed = ledger("D", B1="inferior", B2="inferior", B3="inferior")
    rigs = [ledger("A"), ledger("B", B3="undecided"), ledger("C", "rig", B1="inferior")]
    assert "pays on the A rig and is mixed or undecided on the others;" in said(*rigs)[1]
    assert "the reservoir is mixed or undecided on all these rigs;" in said(*rigs[1:])[1]
    assert "pays on the A rig and harms on the D rig;" in said(rigs[0], harmed)[1]
    assert "the reservoir pays on the A rig;" in said(rigs[0])[1]


def test_points_have_two_sentences_at_most(make_world):
    worlds = [make_world("dry", spread=0.02), make_world("drawn", builds=2, units=9)]
    points = advice(worlds, [judge_world(world, TITLES) for world in worlds], TITLES)
    assert len(points) == 5
    assert all(len(re.findall(r"\.( |$)", point)) == 2 for point in points)


def test_best_models_without_a_second_actuator_are_named_with_their_rigs(make_world):
    worlds = [make_world(spread=0.0), make_world("viscous", spread=0.0, ratios={"bank": 0.5})]
    third = advice(worlds, [judge_world(world, TITLES) for world in worlds], TITLES)[2]
    assert third.endswith(
        "For the lowest forward test error take Bank, tuned (dry 12.0 kPa) or Bank (viscous 6.00 "
        "kPa)."
    )
    assert third.startswith("Without a second actuator, for the lowest tracking error in open loop")
    assert "FPRC" not in third
    assert "oracle" not in third


def test_model_of_fewer_seeds_is_no_advice(make_world):
    world = make_world(spread=0.0, ratios={"mlp": 0.5})
    assert "take mlp (dry 6.00 kPa)" in advised(world)[2]
    for cell in world["cells"][3:]:
        del cell["models"]["mlp"]
    assert "mlp" not in advised(world)[2]


def test_what_tuning_and_a_fall_of_p_o_do_is_said_in_numbers(make_world):
    better = make_world(spread=0.0)
    worse = make_world("viscous", spread=0.0, ratios={"fprc_tuned": 1.2})
    worlds = [better, worse]
    points = advice(worlds, [judge_world(world, TITLES) for world in worlds], TITLES)
    assert (
        "changes its forward test error by -5 % (dry) to +20 % (viscous) and its tra" in points[3]
    )
    assert "misleads" not in points[3]
    assert "misleads: it changes its forward test error by +20 % (viscous)" in advised(worse)[3]
    cell = better["cells"][0]["models"]
    before, after = cell["fprc"]["forward"]["test_rmse_kpa"], cell["fprc"]["shifted"]["-2.0"]
    assert f"goes from {before:.1f} to {after:.1f} kPa" in points[4]


def test_worlds_of_failures_give_five_points(make_world):
    world = make_world(cells=[{"unit": 0, "seed": 1, "failed": "no pressure"}], capacity=None)
    world["training_length"] = None
    points = advised(world)
    assert len(points) == 5
    assert points[2] == "No model was measured."


@pytest.mark.parametrize(("error", "verb"), [(11.0, "does as much as"), (13.0, "does less than")])
def test_second_training_log_is_compared_with_p_o(make_world, error, verb):
    world = make_world("dry", spread=0.0)
    errors = np.array([error - 0.5, error + 0.5])
    world["training_length"] = [
        {"seed": 601 + k, "two_logs": True, "models": {
            "fprc": {"test_rmse_kpa": 10.0}, "fprc_lowpass": {"test_rmse_kpa": own},
        }}
        for k, own in enumerate(errors)
    ]  # fmt: skip
    assert advised(world)[1].endswith(
        f" a second training log that resembles the test log {verb} P_o: on the dry rig it brings "
        f"Low-pass from 15.6 to {error:.1f} kPa, and FPRC from 12.0 to 10.0 kPa."
    )
    world["training_length"] = [{"seed": 601, "seconds": 30.0, "models": {}}]
    assert "second training log" not in advised(world)[1]
