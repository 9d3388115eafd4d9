"""Competitors on blocks of a recording, against regressions by hand."""

import numpy as np
import pytest

from fprc.config import Settings
from fprc.errors import EvaluationError
from fprc.experiments import competitors
from fprc.experiments.competitors import judge_competitor, recording_blocks
from fprc.experiments.data import Data
from fprc.experiments.settings import Judgement
from fprc.registry import build

MODELS = Settings().model_dump(mode="json")["models"]
N_Y, N_U, EPSILON, ALPHA = MODELS["n_y"], *(MODELS["fprc"][key] for key in ("n_u", "epsilon")), 1e-3


@pytest.fixture
def judgement():
    return Judgement(MODELS, folds=5, split="blocked", seed=1, purge_s=0.5)


def data_of(channels, *lengths):
    several = {f"sweep_{i}.h5": length for i, length in enumerate(lengths)}
    return Data(channels, {"recordings": several} if several else {})


def features_by_hand(theta, p_o):
    """Return a bias, taps of theta, and taps of P_o after a low-pass that starts at rest."""
    smooth = [p_o[0]]
    for value in p_o[1:]:
        smooth.append((1 - EPSILON) * smooth[-1] + EPSILON * value)
    columns = [np.ones(len(theta))]
    for signal, count in ((theta, N_Y), (np.array(smooth), N_U)):
        columns += [np.concatenate([np.full(k, signal[0]), signal[: len(signal) - k]])
                    for k in range(count)]  # fmt: skip
    return np.column_stack(columns)


def error_by_hand(train, y, test, wanted):
    weights = np.linalg.solve(train.T @ train + ALPHA * np.eye(train.shape[1]), train.T @ y)
    return np.sqrt(np.mean((test @ weights - wanted) ** 2))


def test_errors_of_a_ridge_are_those_by_hand(seen, judgement):
    """Two recordings of 12 and 8 s: blocks do not cross, features restart, neighbours are out."""
    train, test = data_of(seen["sweep"], 2400, 1600), data_of(seen["complex"])
    folds = recording_blocks(train, judgement)
    found = judge_competitor("ridge_p_o", train, test, folds, judgement)
    theta, p_o, y = (train.channels[n] for n in ("theta_deg", "p_o_kpa", "p_target_kpa"))
    rows = np.vstack([features_by_hand(theta[part], p_o[part])
                      for part in (slice(2400), slice(2400, None))])  # fmt: skip
    expected = []
    for first, last, begin, end in (
        *((400 * i, 400 * (i + 1), 0, 2400) for i in range(6)),
        *((2400 + 400 * i, 2800 + 400 * i, 2400, 4000) for i in range(4)),
    ):
        out = np.zeros(4000, dtype=bool)
        out[max(first - 100, begin) : min(last + 100, end)] = True
        block = slice(first, last)
        expected.append(error_by_hand(rows[~out], y[~out], rows[block], y[block]))
    assert found["validation_rmse_kpa"] == pytest.approx(expected, rel=1e-6)
    other = test.channels
    tested = features_by_hand(other["theta_deg"], other["p_o_kpa"])
    assert found["test_rmse_kpa"] == pytest.approx(
        error_by_hand(rows, y, tested, other["p_target_kpa"]), rel=1e-6
    )


@pytest.mark.parametrize(("purge_s", "blocks"), [(0.5, 10), (1.5, 6), (0.0, 10)])
def test_blocks_are_as_many_as_two_purges_allow(seen, judgement, purge_s, blocks):
    how = Judgement(**{**vars(judgement), "purge_s": purge_s})
    assert len(recording_blocks(data_of(seen["sweep"]), how)) == blocks


@pytest.mark.parametrize(
    ("samples", "blocks"),
    [(8000, 10), (7999, 10), (7981, 10), (7800, 9)],  # of 40 s; 7981 were interpolated from 10 Hz
)
def test_ten_blocks_come_of_40_s_without_their_last_samples(judgement, samples, blocks):
    train = data_of({"time_s": np.arange(samples) / 200.0})
    how = Judgement(**{**vars(judgement), "purge_s": 2.0})
    assert len(recording_blocks(train, how)) == blocks


@pytest.mark.parametrize(
    ("rate_hz", "name", "changed"),
    [
        (200.0, "nvar", {}),
        (100.0, "nvar", {"spacing": 12}),
        (50.0, "bank", {"epsilons": pytest.approx([1 - 0.97**4, 1 - 0.99**4, 1 - 0.997**4])}),
        (50.0, "ridge_p_o", {}),
    ],
)
def test_settings_of_a_competitor_alone_fit_the_rate(
    seen, judgement, monkeypatch, rate_hz, name, changed
):
    given = []

    def built(name, models, seed, **own):
        given.append(own)
        return build(name, models, seed, **own)

    monkeypatch.setattr(competitors, "build", built)
    train = Data(seen["sweep"], {"sample_rate_hz": rate_hz})
    judge_competitor(name, train, train, recording_blocks(train, judgement), judgement)
    assert given == [changed]


def test_blocks_are_longer_than_the_memory(seen, judgement):
    slow = {**MODELS, "fprc": {**MODELS["fprc"], "epsilon": 0.005}}
    how = Judgement(**{**vars(judgement), "models": slow})
    folds = recording_blocks(data_of(seen["sweep"]), how)
    assert {len(block) for _, block in folds} <= {666, 667}


def test_network_at_too_many_samples_is_refused(seen, judgement):
    large = {**MODELS, "esn": {**MODELS["esn"], "r": 20_000}}
    how = Judgement(**{**vars(judgement), "models": large})
    train = data_of(seen["sweep"])
    with pytest.raises(EvaluationError, match="at most 3000 samples, or set models.esn.r"):
        judge_competitor("esn", train, train, recording_blocks(train, how), how)
