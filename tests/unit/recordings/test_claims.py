"""Verdicts on one's own recording."""

import math

import numpy as np
import pytest

from fprc.recordings.claims import CLAIMS, answer, judge_recording, sentences

MODELS = ("fprc", *(other for _, other in CLAIMS.values()))


def report(blocks=10, overlap=1 / 9, spread=0.01, **ratios):
    """Return errors of 10 on each block, those of FPRC by a ratio to each other model."""
    noise = np.random.default_rng(2).standard_normal((len(MODELS), blocks))
    cells = [
        {
            "model": name,
            "validation_rmse_kpa": list(10.0 / ratios.get(name, 1.0) * np.exp(spread * own)),
        }
        for name, own in zip(MODELS, noise, strict=True)
    ]
    return {"cells": cells, "overlap": overlap}


def verdicts(results):
    return {row["id"]: row["verdict"] for row in judge_recording(results)}


@pytest.mark.parametrize(
    ("ratios", "first"),
    [
        ({"fprc_lowpass": 0.7, "fuzzy_linear": 0.7}, "Yes"),
        ({"fprc_lowpass": 0.7, "fuzzy_linear": 1.5}, "No"),
        ({"fprc_lowpass": 1.5, "fuzzy_linear": 0.7}, "No"),
        ({"fprc_lowpass": 1.0, "fuzzy_linear": 0.7}, "No"),
        ({"fprc_lowpass": 0.7, "fuzzy_linear": 0.7, "blocks": 5}, "Not decided"),
        ({"fprc_lowpass": 0.7, "fuzzy_linear": 0.7, "blocks": 1}, "Not judged"),
    ],
)
def test_answer_needs_both_comparisons(ratios, first):
    rows = judge_recording(report(**ratios))
    assert answer(rows).startswith(f"**{first}**: ")


@pytest.mark.parametrize(
    ("ratios", "claim"),
    [({"blocks": 5}, 2), ({"fuzzy_linear": 0.7, "spread": 0.1}, 2), ({"fuzzy_linear": 0.7}, 0)],
)
def test_answer_has_the_claim_that_is_undecided_and_why(ratios, claim):
    rows = judge_recording(report(**{"fprc_lowpass": 0.97, **ratios}))
    rows[claim] |= {"verdict": "undecided", "reason": "Only one day."}
    text = answer(rows)
    assert text.startswith("**Not decided**: ")
    assert f"{rows[claim]['claim']}. Only one day." in text


def test_clear_pairs_are_decided_and_named():
    results = report(fprc_lowpass=0.7, ridge_p_o=1.5)
    assert verdicts(results) == {"B1": "superior", "B4": "inferior", "R1": "equivalent"}
    assert "(B1): superior. FPRC's error is 0.70" in sentences(judge_recording(results))[0]


def test_ratio_and_interval_are_those_of_the_corrected_t_test_after_holm():
    results = report(spread=0.1)
    row = judge_recording(results)[0]
    ours, theirs = (np.log(results["cells"][i]["validation_rmse_kpa"]) for i in (0, 1))
    ratios = ours - theirs
    assert row["ratio"] == pytest.approx(math.exp(ratios.mean()))
    assert row["level"] == pytest.approx(0.05 / 3)  # nothing is decided
    half = 2.9333 * math.sqrt((1 / 10 + 1 / 9) * ratios.var(ddof=1))
    assert math.log(row["high"] / row["ratio"]) == pytest.approx(half, rel=1e-4)


def test_verdict_that_few_subsets_share_is_shown_as_unstable_and_counts_as_undecided(monkeypatch):
    monkeypatch.setattr("fprc.evaluation.paired._share_of_subsets", lambda *rest: 0.9)
    rows = judge_recording(report(fprc_lowpass=0.7, fuzzy_linear=1.5))
    first, _, last = sentences(rows)
    assert "(B1): superior, unstable. FPRC's error is 0.70" in first
    assert "(R1): inferior, unstable. " in last
    assert "stays in 90 % of the cases; 95 % are needed, so it counts as undecided." in first
    assert answer(rows).startswith("**Not decided**: ")


def test_model_without_errors_leaves_its_claim_unjudged():
    results = report(fprc_lowpass=0.7)
    results["cells"][2] = {"model": "ridge_p_o", "reason": "too long"}
    rows = judge_recording(results)
    assert [row["verdict"] for row in rows] == ["superior", "not judged", "equivalent"]
    assert rows[1]["ratio"] is None


def test_block_without_error_is_no_pair():
    results = report(fprc_lowpass=0.7)
    results["cells"][1]["validation_rmse_kpa"][0] = 0.0
    assert [row["blocks"] for row in judge_recording(results)] == [9, 10, 10]
