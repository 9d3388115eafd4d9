"""Competitors on blocks of a recording."""

from dataclasses import replace

import numpy as np
import pytest

from fprc.config import Settings
from fprc.evaluation import rmse
from fprc.experiments.data import Data
from fprc.experiments.settings import Judgement
from fprc.models import RidgeReadout, TapFeatures
from fprc.recordings import competitors
from fprc.recordings.competitors import judge_competitor, recording_blocks, shifted
from fprc.registry import build

MODELS = Settings().model_dump(mode="json")["models"]
N_Y, N_U, EPSILON = MODELS["n_y"], *(MODELS["fprc"][key] for key in ("n_u", "epsilon"))


@pytest.fixture
def judgement():
    return Judgement(MODELS, folds=5, split="blocked", seed=1, purge_s=0.5)


def data_of(channels, *lengths):
    several = {f"sweep_{i}.h5": length for i, length in enumerate(lengths)}
    return Data(channels, {"recordings": several} if several else {})


def test_errors_of_a_ridge_are_those_of_its_blocks(seen, judgement):
    """Two recordings of 12 and 8 s: blocks do not cross, features restart, neighbours are out."""
    train, test = data_of(seen["sweep"], 2400, 1600), data_of(seen["complex"])
    found = judge_competitor({"model": "ridge_p_o"}, train=train, test=test, judgement=judgement)
    X, y, _ = train.samples("ridge_p_o")
    taps = TapFeatures(N_Y, n_u=N_U, epsilon=EPSILON).fit(X)
    rows = np.vstack([taps.transform(part) for part in (X[:2400], X[2400:])])

    def error(training, tested, wanted):
        readout = RidgeReadout(alpha=1e-3).fit(rows[training], y[training])
        return rmse(wanted, readout.predict(tested))

    expected = []
    for first, last, begin, end in (
        *((400 * i, 400 * (i + 1), 0, 2400) for i in range(6)),
        *((2400 + 400 * i, 2800 + 400 * i, 2400, 4000) for i in range(4)),
    ):
        out = np.zeros(4000, dtype=bool)
        out[max(first - 100, begin) : min(last + 100, end)] = True
        block = slice(first, last)
        expected.append(error(~out, rows[block], y[block]))
    assert found["validation_rmse_kpa"] == pytest.approx(expected, rel=1e-6)
    other, wanted, _ = test.samples("ridge_p_o")
    whole = error(slice(None), taps.transform(other), wanted)
    assert found["test_rmse_kpa"] == pytest.approx(whole, rel=1e-6)


@pytest.mark.parametrize(
    ("samples", "purge_s", "epsilon", "blocks"),
    [
        # two purges long at least
        (4000, 0.5, 0.01, 10),
        (4000, 1.5, 0.01, 6),
        (4000, 0.0, 0.01, 10),
        # of 40 s without their last samples; 7981 were interpolated from 10 Hz
        (8000, 2.0, 0.01, 10),
        (7999, 2.0, 0.01, 10),
        (7981, 2.0, 0.01, 10),
        (7800, 2.0, 0.01, 9),
        # longer than the memory
        (4000, 0.5, 0.005, 6),
    ],
)
def test_blocks_are_as_many_as_purge_and_memory_allow(judgement, samples, purge_s, epsilon, blocks):
    models = {**MODELS, "fprc": {**MODELS["fprc"], "epsilon": epsilon}}
    how = replace(judgement, purge_s=purge_s, models=models)
    train = data_of({"time_s": np.arange(samples) / 200.0})
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
    judge_competitor({"model": name}, train=train, test=train, judgement=judgement)
    assert given == [changed]


def test_network_at_too_many_samples_is_refused(seen, judgement, monkeypatch):
    columns = MODELS["esn"]["r"] + MODELS["n_y"]
    monkeypatch.setattr(competitors, "_MOST_BYTES", 8 * columns * 1234)
    train = data_of(seen["sweep"])
    found = judge_competitor({"model": "esn"}, train=train, test=train, judgement=judgement)
    assert "1,234" in found["reason"]


@pytest.mark.parametrize("seed", range(5))
def test_shifted_p_o_is_that_of_another_time_of_the_same_recording(seed):
    p_o = np.linspace(100.0, 60.0, 500)  # it leaks
    theta, lengths = np.arange(500.0), (200, 300)
    channels = {"time_s": theta / 200.0, "theta_deg": theta, "p_target_kpa": theta, "p_o_kpa": p_o}
    X, y, _ = shifted(data_of(channels, *lengths), seed).samples("fprc_shifted")
    np.testing.assert_array_equal(X[:, 0], theta)
    np.testing.assert_array_equal(y, theta)
    begin = 0
    for length in lengths:
        whole, found = p_o[begin : begin + length], X[begin : begin + length, 1]
        begin += length
        (shift,) = np.flatnonzero(found == whole[0])
        np.testing.assert_array_equal(np.roll(whole, shift), found)
        assert 0.24 * length < shift < 0.76 * length


def test_fprc_on_shifted_p_o_learns_nothing_from_p_o(judgement):
    rng = np.random.default_rng(1)
    time_s = np.arange(2000) / 200.0
    theta, p_o = 20.0 * np.sin(3.0 * time_s), np.cumsum(rng.standard_normal(2000))
    channels = {"time_s": time_s, "theta_deg": theta, "p_o_kpa": p_o, "p_target_kpa": theta + p_o}
    log = data_of(channels)
    fprc, control = (
        judge_competitor({"model": name}, train=log, test=log, judgement=judgement)
        for name in ("fprc", "fprc_shifted")
    )
    assert np.mean(fprc["test_rmse_kpa"]) < 0.5 * np.mean(control["test_rmse_kpa"])
