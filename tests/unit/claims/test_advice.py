"""Sentences that follow from verdicts and numbers."""

import numpy as np
import pytest

from fprc.claims.advice import LOOPS, advice
from fprc.claims.beyond import CLAIMS, judge_world

TITLES = {"fprc": "FPRC", "bank": "Bank", "fuzzy_linear": "Fuzzy-linear"}
VERDICTS = ("superior", "equivalent", "inferior", "undecided", "not judged")


def ledger(title, ratio=0.8, **verdicts):
    return [
        {
            "id": name,
            "title": title,
            "verdict": verdicts.get(name, "superior"),
            "parts": [] if verdicts.get(name) == "not judged" else [{"mean": ratio}],
        }
        for name in CLAIMS
    ]


def said(*ledgers, names=("dry", "viscous")):
    worlds = [
        {"name": name, "title": own[0]["title"], "cells": []}
        for name, own in zip(names, ledgers, strict=True)
    ]
    return advice(worlds, ledgers, TITLES)


@pytest.mark.parametrize("verdict", VERDICTS)
@pytest.mark.parametrize(("claim", "point"), [("B1", 0), ("B3", 1)])
def test_a_decided_loss_is_said_beside_what_is_undecided(verdict, claim, point):
    text = said(ledger("A", **{claim: "inferior"}, ratio=2.5), ledger("B", **{claim: verdict}))[
        point
    ]
    assert f"higher on A ({LOOPS['dry']}): 150 %" in text
    kinds = {"superior": "lower on B", "equivalent": "same within 5 % on B",
             "inferior": f"; B ({LOOPS['viscous']}): 20 %", "undecided": "not decided on B",
             "not judged": "not measured on B"}  # fmt: skip
    assert kinds[verdict] in text


def test_size_and_sign_of_what_is_undecided_are_said():
    for ratio, words in ((0.9, "-10 %"), (1.04, "+4 %"), (0.996, ": 0 %")):
        text = said(ledger("A", ratio, B1="undecided"), names=("dry",))[0]
        assert "not decided on A" in text
        assert words in text


def test_best_models_are_named_with_and_without_a_second_actuator(make_world):
    world = make_world(spread=0.0)
    third = advice([world], [judge_world(world, TITLES)], TITLES)[2]
    assert (
        "lowest forward test error that of FPRC, tuned (11.4 kPa) (without a second actuator"
        in third
    )
    assert "Bank, tuned (12 kPa)" in third
    assert "chosen on the test log" not in third
    assert third.index("lowest tracking") < third.index("lowest forward")


def test_best_model_that_needs_no_reservoir_is_named_once(make_world):
    world = make_world(spread=0.0, ratios={"bank": 0.5})
    third = advice([world], [judge_world(world, TITLES)], TITLES)[2]
    assert "test error that of Bank (6 kPa)" in third
    assert "actuator" not in third.split("test error")[1]


def test_models_that_chance_could_put_first_are_named_too(make_world):
    world = make_world(spread=0.0)
    noise = np.random.default_rng(1).normal(0.0, 0.05, len(world["cells"]))
    for cell, factor in zip(world["cells"], np.exp(noise - noise.mean() + 0.001), strict=True):
        lowest = cell["models"]["fprc_tuned"]["forward"]["test_rmse_kpa"]
        cell["models"]["bank"]["forward"] = {"test_rmse_kpa": lowest * factor}
        cell["models"]["esn"]["forward"] = {"test_rmse_kpa": lowest * factor * 1.1}
    third = advice([world], [judge_world(world, TITLES)], TITLES)[2].split("test error")[1]
    assert "FPRC, tuned (11.4 kPa), Bank (11.4 kPa) (" in third


def test_verdicts_are_grouped_by_world():
    sentences = said(
        ledger("A", B6="inferior", B7="equivalent"), ledger("B", B6="undecided", B7="equivalent")
    )
    assert "on the same features: better on A and B." in sentences[3]
    assert "tuned as much: worse on A, undecided on B." in sentences[3]
    assert sentences[4].endswith("FPRC against Fuzzy-linear: equal within 5 % on A and B.")


def test_what_tuning_and_a_fall_of_p_o_do_is_said_in_numbers(make_world):
    world = make_world(spread=0.0)
    sentences = advice([world], [judge_world(world, TITLES)], TITLES)
    assert "changes FPRC's test error by -5 % on" in sentences[3]
    cell = world["cells"][0]["models"]
    before, after = cell["fprc"]["forward"]["test_rmse_kpa"], cell["fprc"]["shifted"]["-2.0"]
    assert f"rises from {before:.1f} to {after:.1f} kPa" in sentences[4]


def test_worlds_of_failures_give_five_points(make_world):
    world = make_world(cells=[{"unit": 0, "seed": 1, "failed": "no pressure"}], capacity=None)
    world["training_length"] = None
    sentences = advice([world], [judge_world(world, TITLES)], TITLES)
    assert len(sentences) == 5
    assert sentences[2] == "No model was measured."


def test_training_on_two_logs_is_said_where_it_was_measured(make_world):
    world = make_world("dry", spread=0.02)
    errors = {"fprc": 10.0, "fprc_lowpass": 12.0, "bank": 9.0}
    models = [
        {name: {"test_rmse_kpa": error + k} for name, error in errors.items()} for k in (0, 1)
    ]
    both = [{"seed": k, "two_logs": True, "models": models[k]} for k in (0, 1)]
    alone = {"seed": 0, "seconds": 30.0, "models": models[0]}
    world["training_length"] = [*both, alone]
    sentences = advice([world], [judge_world(world, TITLES)], TITLES)[0]
    assert "10.5 kPa with P_o and 12.5 kPa with low-passed theta" in sentences
    assert "that of Bank, 9.5 kPa." in sentences
    world["training_length"] = [alone]
    assert "second log" not in advice([world], [judge_world(world, TITLES)], TITLES)[0]
