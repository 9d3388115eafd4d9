import copy

import numpy as np
import pytest
import yaml

from fprc.config import PUBLISHED, Settings
from fprc.config.rig import LONGEST_LAG_S, Rig, squeeze_lag
from fprc.errors import EvaluationError
from fprc.experiments.comparison import CrossValidation, compare_models
from fprc.experiments.data import simulate
from fprc.studies.calibration import fit, surrogate
from fprc.studies.calibration.fit import fit_rig
from fprc.studies.calibration.objective import errors_of, printed_errors
from fprc.studies.calibration.rig_file import parameter_file
from fprc.studies.calibration.space import encode, free_parameters

pytestmark = pytest.mark.slow  # whole fits

PRINTED = yaml.safe_load(PUBLISHED.read_text(encoding="utf-8"))
FREE = ["bending.friction_kpa", "bending.friction_per_kpa", "bending.stiffness_kpa_per_deg"]


@pytest.fixture(scope="module", autouse=True)
def small():
    with pytest.MonkeyPatch.context() as patch:
        for module, name, value in (
            (surrogate, "STRIDE", 7), (surrogate, "ESN_NODES", 8), (fit, "_DRAWN", 2),
            (fit, "_FEW", 1),
        ):  # fmt: skip
            patch.setattr(module, name, value)
        yield


@pytest.fixture(scope="module")
def settings(on_rig, tracking):
    """What the fit takes, with short signals and small models."""
    found = Settings().model_dump(mode="json")
    models = found["models"] | {"n_y": 2}
    models["esn"] |= {"r": 12, "washout": 10}
    models["fprc"] |= {"n_c": 2, "n_u": 2}
    few = {"free": FREE, "ranges": {}, "members": 6, "starts": 2, "rounds": 1, "last_rounds": 1}
    return {
        "on_rig": on_rig,
        "validation": {"models": models, "folds": 2, "split": "shuffled"},
        "calibration": found["calibration"] | few | {"full_seeds": 2},
        "tracking": tracking,
        "workers": 1,
    }


@pytest.fixture(scope="module")
def fitted(settings):
    return fit_rig(PRINTED, **settings)


def test_fit_does_not_depend_on_the_rig_that_it_is_given(settings, fitted):
    other = copy.deepcopy(settings["on_rig"].rig)
    other["bending"] |= {"friction_kpa": 14.0, "friction_per_kpa": 0.2}
    found = fit_rig(PRINTED, **settings | {"on_rig": settings["on_rig"].changed(rig=other)})
    assert found == fitted


def test_fitted_rig_is_valid_and_its_file_gives_it_back(fitted):
    rig, summary = fitted
    assert squeeze_lag(Rig.model_validate(rig).model_dump()) <= LONGEST_LAG_S
    of_file = yaml.safe_load(parameter_file(rig, summary, "mine"))
    assert Rig.model_validate(of_file["rig"]) == Rig.model_validate(rig)
    shares = [*summary["shares"].values()]
    assert encode(rig, free_parameters(FREE)) == pytest.approx(shares, abs=0.002)


def test_outcome_is_that_of_the_full_models(settings, fitted):
    rig, summary = fitted
    on_rig = settings["on_rig"].changed(rig=rig)
    first = fit.FIRST_SEED + fit.SEEDS_PER_FIT * settings["calibration"]["seed"] + fit._FULL
    errors = []
    for seed in (first, first + 1):
        validation = CrossValidation(**settings["validation"], seed=seed)
        errors.append(errors_of(compare_models(simulate(on_rig, seed), validation)[0]))
    off = [abs(np.mean([seed[key] for seed in errors]) / value - 1.0)
           for key, value in printed_errors(PRINTED).items()]  # fmt: skip
    found = [summary["brief"][name] for name in ("median", "largest")]
    assert found == pytest.approx([np.median(off), np.max(off)], rel=1e-6)
    assert summary["brief"].keys() == fit.LIMITS.keys()


def test_ranges_that_no_rig_can_have_are_refused(settings, monkeypatch):
    monkeypatch.setattr(fit.Bench, "judge", lambda *_: None)
    with pytest.raises(EvaluationError, match=r"calibration\.ranges"):
        fit_rig(PRINTED, **settings)
