"""B1, B4 and R1 on one's own recording."""

import math

import numpy as np
import pytest

from fprc.config import Settings
from fprc.evaluation.sides import Recordings
from fprc.recordings import paper_models
from fprc.recordings.paper_models import CLAIMS, MODELS, judge_claims, judge_models, sentences

SETTINGS = Settings().model_dump(mode="json")["models"]


def cells(blocks=10, spread=0.01, **ratios):
    """Return errors of 10 on each block, those of FPRC by a ratio to each other model."""
    noise = np.random.default_rng(2).standard_normal((len(MODELS), blocks))
    return [
        {"model": name, "blocks": list(10.0 / ratios.get(name, 1.0) * np.exp(spread * own))}
        for name, own in zip(MODELS, noise, strict=True)
    ]


def test_ratio_and_interval_are_those_of_the_corrected_t_test_after_holm():
    given = cells(spread=0.1)
    row = judge_claims(given, 1 / 9)[0]
    errors = {cell["model"]: np.log(cell["blocks"]) for cell in given}
    ratios = errors["fprc"] - errors[CLAIMS["B1"][1]]
    assert row["mean"] == pytest.approx(math.exp(ratios.mean()))
    assert row["level"] == pytest.approx(0.05 / 3)  # nothing is decided
    half = 2.9333 * math.sqrt((1 / 10 + 1 / 9) * ratios.var(ddof=1))
    assert math.log(row["high"] / row["mean"]) == pytest.approx(half, rel=1e-4)


def test_model_without_errors_leaves_its_claim_unjudged():
    given = cells(fprc_lowpass=0.7)
    given[-1] = {"model": "ridge_p_o", "reason": "too long"}
    rows = judge_claims(given, 1 / 9)
    assert [row["verdict"] for row in rows] == ["superior", "not judged", "equivalent"]
    assert "FPRC's error is 0.698" in sentences(rows)[0]
    assert "fewer than" in sentences(judge_claims(cells(7, spread=0.1), 1 / 9))[0]


def test_network_of_too_many_samples_is_left_out(seen, monkeypatch):
    monkeypatch.setattr(paper_models, "MOST_BYTES", 8 * 1000 * 805)
    channels = (seen["sweep"][name] for name in ("theta_deg", "p_o_kpa", "p_target_kpa"))
    found = judge_models(Recordings(*channels, [4000], 100.0), SETTINGS, 1)
    assert [cell["model"] for cell in found if "reason" in cell] == ["esn"]
    assert all(len(cell["blocks"]) == 5 for cell in found if "blocks" in cell)
