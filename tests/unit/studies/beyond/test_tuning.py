import numpy as np
import pytest

from fprc.config import Settings
from fprc.experiments.data import Data
from fprc.experiments.settings import Judgement
from fprc.registry import build
from fprc.studies.beyond.tuning import SPACES, candidates_of, chosen, judge_candidate

MODELS = Settings().models.model_dump()


@pytest.mark.parametrize("name", SPACES)
def test_candidates_are_the_defaults_and_distinct_models(name):
    candidates = candidates_of(name, 12, 1)
    assert candidates[0] == {}
    assert len({str(settings) for settings in candidates}) == len(candidates) == 12
    assert candidates == candidates_of(name, 12, 1) != candidates_of(name, 12, 2)
    for settings in candidates:
        build(name, MODELS, 1, **settings)


@pytest.mark.parametrize("name", ["bank", "plays"])
def test_filters_of_a_bank_are_spaced_evenly_by_their_logarithm(name):
    for settings in candidates_of(name, 12, 1)[1:]:
        steps = np.diff(np.log(settings["epsilons"]))
        assert (steps < 0).all()
        np.testing.assert_allclose(steps, steps[0], rtol=2e-3)
        assert settings["epsilons"][0] <= 0.3
        assert settings["epsilons"][-1] >= 0.001


@pytest.fixture
def pair(seen):
    attributes = {"experiment": "sweep", "source": "sim"}
    return {name: Data(channels, attributes) for name, channels in seen.items()}


@pytest.fixture
def judgement():
    return Judgement(MODELS, folds=3, split="blocked", seed=1, purge_s=1.0)


def test_candidate_is_judged_on_blocks_of_rows_that_it_has_not_seen(pair, judgement):
    X = pair["sweep"].channels["theta_deg"][:, None]
    y = pair["sweep"].channels["p_target_kpa"]
    found = judge_candidate(
        {"model": "bank", "settings": {"alpha": 2.0}}, logs=[pair], judgement=judgement
    )
    rows = build("bank", MODELS, 1, alpha=2.0).make_features().fit(X).transform(X)
    rows = np.column_stack([np.ones(len(rows)), rows])
    errors = []
    for block in np.array_split(np.arange(len(y)), 3):
        train = np.ones(len(y), dtype=bool)
        train[max(block[0] - 200, 0) : block[-1] + 201] = False
        gram = rows[train].T @ rows[train] + 2.0 * np.eye(rows.shape[1])
        weights = np.linalg.solve(gram, rows[train].T @ y[train])
        errors.append(np.sqrt(np.mean((rows[block] @ weights - y[block]) ** 2)))
    assert found["validation_rmse_kpa"] == pytest.approx(np.mean(errors), rel=1e-6)


def test_errors_of_several_logs_are_averaged_by_their_logarithm(pair, judgement):
    swapped = {"sweep": pair["complex"], "complex": pair["sweep"]}
    one, other, both = (
        judge_candidate({"model": "bank", "settings": {}}, logs=logs, judgement=judgement)
        for logs in ([pair], [swapped], [pair, swapped])
    )
    for name, value in both.items():
        assert value == pytest.approx(np.sqrt(one[name] * other[name]))


def candidate(number, train, validation, test):
    return {
        "settings": {"alpha": number},
        "train_rmse_kpa": train,
        "validation_rmse_kpa": validation,
        "test_rmse_kpa": test,
    }


def test_choice_by_validation_by_test_and_by_fprcs_training_error():
    judged = {
        "fprc": [candidate(1, 10.0, 12.0, 13.0), candidate(2, 9.0, 11.0, 20.0)],
        "esn": [candidate(3, 5.0, 9.0, 30.0), candidate(4, 9.5, 14.0, 16.0),
                candidate(5, 14.0, 15.0, 12.0)],
    }  # fmt: skip
    numbers = {name: settings["alpha"] for name, settings in chosen(judged).items()}
    assert numbers == {
        "fprc_tuned": 2, "fprc_oracle": 1, "esn_tuned": 3, "esn_oracle": 5, "esn_matched": 4,
    }  # fmt: skip
    del judged["esn"]
    assert set(chosen(judged)) == {"fprc_tuned", "fprc_oracle"}
