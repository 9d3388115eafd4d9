"""Sentences that follow from verdicts."""

from itertools import product

import pytest

from fprc.claims.advice import advice
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
    worlds = [{"name": name, "cells": []} for name, _ in zip(names, ledgers, strict=False)]
    return advice(worlds, ledgers, TITLES)


@pytest.mark.parametrize(("dry", "viscous"), list(product(VERDICTS, VERDICTS)))
def test_what_makes_the_loops_comes_first(dry, viscous):
    first = said(ledger("A", B1=dry), ledger("B", B1=viscous))[0]
    depends = "does not depend" if dry == viscous else "depends"
    assert first.startswith(
        f"The worth of P_o {depends} on what makes the loops: with dry friction"
    )
    assert "with a viscous memory" in first


def test_size_of_the_effect_is_said():
    first = said(ledger("A", ratio=0.77), ledger("B", ratio=1.2, B1="inferior"))[0]
    assert "dry friction, P_o gives FPRC 23 % less test error than" in first
    assert "viscous memory, P_o gives FPRC 20 % more test error than" in first


def test_one_kind_of_loops_is_not_generalised():
    assert said(ledger("A"))[0].endswith("loops of another kind were not run.")
    assert said(ledger("A"), names=("drawn",))[0].startswith("Neither")


@pytest.mark.parametrize(
    ("forward", "tracking", "text"),
    [
        ("superior", "superior", "improves both test error and tracking"),
        ("equivalent", "inferior", "improves neither"),
        ("superior", "equivalent", "improves only one of the two"),
        ("superior", "undecided", "has an undecided effect on one or both"),
        ("not judged", "superior", "has an undecided effect on one or both"),
    ],
)
def test_reservoir_pays_where_both_are_better(forward, tracking, text):
    rows = ledger("A", B1=forward, B3=tracking)
    assert f"{text} everywhere." in said(rows)[1]
    mixed = said(ledger("other", B1="inferior", B3="equivalent"), rows)[1]
    if text != "improves neither":
        assert f"improves neither on other, but {text} on A." in mixed


def test_best_model_is_named_with_and_without_a_second_actuator(make_world):
    world = make_world(spread=0.0)
    third = advice([world], [judge_world(world, TITLES)], TITLES)[2]
    # the oracles are lower
    assert third.startswith(
        "With dry friction the lowest mean test error is that of FPRC, tuned (11.4 kPa, 1.77 deg"
    )
    assert "or, without a second actuator, of Bank, tuned (12.0 kPa" in third


def test_best_model_that_needs_no_reservoir_is_named_once(make_world):
    world = make_world(spread=0.0, ratios={"bank": 0.5})
    third = advice([world], [judge_world(world, TITLES)], TITLES)[2]
    assert "that of Bank (6.0 kPa" in third
    assert "without a second actuator" not in third


def test_verdicts_are_grouped_by_world():
    sentences = said(
        ledger("A", B6="inferior", B7="equivalent"), ledger("B", B6="undecided", B7="equivalent")
    )
    assert "beats a ridge on the same features everywhere" in sentences[3]
    assert (
        "FPRC loses to an ESN that was tuned as much on A, but is undecided against it on B."
        in sentences[3]
    )
    assert sentences[4].endswith("FPRC equals Fuzzy-linear within 5 % everywhere.")


def test_worlds_of_failures_give_five_sentences(make_world):
    world = make_world(cells=[{"unit": 0, "seed": 1, "failed": "no pressure"}], capacity=None)
    sentences = advice([world], [judge_world(world, TITLES)], TITLES)
    assert len(sentences) == 5
    assert sentences[2] == "No model can be recommended, since none was measured."


def test_training_on_two_logs_is_said_where_it_was_measured(make_world):
    world = make_world("dry", spread=0.02)
    errors = {"fprc": 10.0, "fprc_lowpass": 12.0, "bank": 9.0, "bank_tuned": 1.0}
    models = [
        {name: {"test_rmse_kpa": error + k} for name, error in errors.items()} for k in (0, 1)
    ]
    both = [{"seed": k, "two_logs": True, "models": models[k]} for k in (0, 1)]
    alone = {"seed": 0, "seconds": 30.0, "models": models[0]}
    world["training_length"] = [*both, alone]
    sentences = advice([world], [judge_world(world, TITLES)], TITLES)[2]
    assert "10.5 kPa with P_o and 12.5 kPa with a low-pass of theta_d" in sentences
    assert "the lowest is Bank with 9.5 kPa" in sentences
    world["training_length"] = [alone]
    assert "second log" not in advice([world], [judge_world(world, TITLES)], TITLES)[2]
