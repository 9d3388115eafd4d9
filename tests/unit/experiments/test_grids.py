import numpy as np
import pytest

from fprc.evaluation import prepare, rmse, split_rows
from fprc.experiments.comparison import normalised, shares_of
from fprc.models import FPRC

SETTINGS = {"epsilon": 0.1, "n_c": 3, "n_u": 2, "n_y": 3, "sigma": 2.0, "alpha": 1e-3}


@pytest.fixture(scope="module")
def data(recorded):
    log = recorded["sweep"]
    X = np.column_stack([log["theta_deg"], log["p_o_kpa"]])[::5]
    return X, log["p_exp_command_kpa"][::5]


def test_shares_are_those_of_the_best_fold_on_normalised_features(data):
    X, y = (values[:400] for values in data)
    folds = split_rows(400, 3, "shuffled", 5)
    model = FPRC(**SETTINGS, random_state=7)
    rows = model.make_features().fit(X).transform(X)
    alpha = model.alpha
    for taps in (rows[:, : model.n_y], rows[:, model.n_y :]):
        taps -= taps.min()
        alpha /= taps.max()
        taps /= taps.max()
    judged = []
    for i, (train, validation) in enumerate(folds):
        own = int(np.random.SeedSequence([7, i]).generate_state(1)[0])
        readout = model.make_readout().set_params(random_state=own, alpha=alpha)
        readout.fit(rows[train], y[train])
        errors = (rmse(y[part], readout.predict(rows[part])) for part in (train, validation))
        judged.append((np.hypot(*errors), np.abs(readout.W_out_)))
    _, weights = min(judged, key=lambda candidate: candidate[0])
    expected = weights / weights.sum(axis=1, keepdims=True)
    prepared = normalised(prepare(model, {"train": (X, y, None)}), "train")
    found = shares_of(prepared.cross_validated("train", folds).model.readout_.W_out_)
    np.testing.assert_allclose(found, expected, rtol=1e-6)
