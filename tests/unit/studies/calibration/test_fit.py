import copy
import re

import numpy as np
import pytest
import yaml
from joblib import Parallel

from fprc.config import PUBLISHED, Settings, check
from fprc.config.rig import LONGEST_LAG_S, Rig, squeeze_lag
from fprc.errors import EvaluationError
from fprc.experiments.comparison import CrossValidation, compare_models
from fprc.experiments.data import simulate
from fprc.studies.calibration import fit, surrogate
from fprc.studies.calibration.fit import Fit, fits, parameter_file
from fprc.studies.calibration.objective import printed_errors

PRINTED = yaml.safe_load(PUBLISHED.read_text(encoding="utf-8"))
TABLE = PRINTED["table_4_tracking_rmse_deg"]
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
        "pool": Parallel(),
    }


@pytest.fixture(scope="module")
def fitted(settings):
    return Fit(PRINTED, **settings).rig_file("mine")


@pytest.mark.slow
def test_fit_does_not_depend_on_the_rig_that_it_is_given(settings, fitted):
    other = copy.deepcopy(settings["on_rig"].rig)
    other["bending"] |= {"friction_kpa": 14.0, "friction_per_kpa": 0.2}
    on_rig = settings["on_rig"].changed(rig=other)
    assert Fit(PRINTED, **settings | {"on_rig": on_rig}).rig_file("mine") == fitted


@pytest.mark.slow
def test_outcome_is_that_of_the_full_models_on_the_rig_of_the_file(settings, fitted):
    rig = Rig.model_validate(yaml.safe_load(fitted)["rig"]).model_dump(mode="json")
    assert squeeze_lag(rig) <= LONGEST_LAG_S
    on_rig = settings["on_rig"].changed(rig=rig)
    first = fit.FIRST_SEED + fit.SEEDS_PER_FIT * settings["calibration"]["seed"] + fit._FULL
    seeds = []
    for seed in (first, first + 1):
        validation = CrossValidation(**settings["validation"], seed=seed)
        seeds.append(compare_models(simulate(on_rig, seed), validation)[0]["models"])
    means = {}
    for reports in zip(*seeds, strict=True):
        key = f"{reports[0]['trained_on']}/{reports[0]['model']}"
        for phase in ("train", "test"):
            means[f"{key}/{phase}"] = np.mean([report[f"{phase}_rmse_kpa"] for report in reports],
                                              axis=0).mean()  # fmt: skip
    off = [abs(means[key] / value - 1.0) for key, value in printed_errors(PRINTED).items()]
    said = [float(share) for share in re.findall(r"^#   \w+: ([\d.]+) %", fitted, re.MULTILINE)]
    assert len(said) == len(fit.LIMITS)
    assert said[:2] == pytest.approx([100 * np.median(off), 100 * np.max(off)], abs=0.051)


@pytest.mark.slow
def test_ranges_that_no_rig_can_have_are_refused(settings, monkeypatch):
    monkeypatch.setattr(fit, "_judged", lambda *_, **__: None)
    with pytest.raises(EvaluationError, match=r"calibration\.ranges"):
        Fit(PRINTED, **settings).rig_file("mine")


@pytest.mark.parametrize(("last", "best"), [(None, 2.0), (9.0, 2.0), (1.0, 1.0)])
def test_better_half_goes_on_and_what_full_models_find_best_is_returned(
    settings, monkeypatch, caplog, last, best
):
    """A point is its own loss, which a round lowers by 1; one start is impossible."""

    def search(self, point, seed, full_seeds):
        return point[0], point[0] - 1.0, point - 1.0

    monkeypatch.setattr(Fit, "round", search)
    monkeypatch.setattr(Fit, "full", lambda *_: None if last is None else [last])
    monkeypatch.setattr(Fit, "loss", lambda _, judged: judged[0])
    calibration = settings["calibration"] | {"rounds": 1, "last_rounds": 2}
    starts = [np.array([loss]) for loss in (9.0, np.inf, 5.0, 7.0)]
    with caplog.at_level("INFO"):
        found = Fit(PRINTED, **settings | {"calibration": calibration}).knockout(starts)
    assert found == [best]
    rounds = [record.args for record in caplog.records]
    assert [of[:2] for of in rounds] == [(done, 8) for done in range(1, 9)]
    assert [of[2] for of in rounds] == [1, 2, 3, 4, 3, 4, 3, 3]
    assert rounds[-1][-1] == 0.0  # minutes left


def test_file_holds_what_differs_from_the_defaults_and_what_was_fitted(tmp_path, monkeypatch):
    calibration = Settings().calibration.model_dump() | {"fit": ("tables", "C8")}
    paths, edges = calibration["free"], (0.0, 0.0199, 0.0201, 0.9799, 0.9801, 1.0)
    shares = dict.fromkeys(paths, 0.5) | dict(zip(paths, edges, strict=False))
    rig = Rig().model_dump(mode="json")
    rig["bending"]["relaxation_time_s"][1] = 5.5
    rig["drift"]["sigma_kpa"] = 1e-5
    brief = {"median": 0.0456, "largest": 0.21}
    text = parameter_file("mine", rig, calibration, shares, brief)
    assert yaml.safe_load(text) == {
        "fitted": {"name": "mine", "to": ["tables", "C8"]},
        "rig": {"bending": {"relaxation_time_s": [0.25, 5.5]}, "drift": {"sigma_kpa": 1e-5}},
    }
    (tmp_path / "config/rigs").mkdir(parents=True)
    (tmp_path / "config/rigs/mine.yaml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert check({"rig": "mine"}).rig == Rig.model_validate(rig)
    head = " ".join(line.removeprefix("# ") for line in text.splitlines() if line[0] == "#")
    assert all(number in head for number in ("4.6 %", "21.0 %"))
    edges = head.partition("an end of their range: ")[2].rstrip(". ")
    assert edges.split(", ") == [paths[k] for k in (0, 1, 4, 5)]


def judged(measure="errors", keys=(), factor=1.0):
    """What the full models find on a rig on which all is as printed, but for some numbers."""
    found = {"errors": printed_errors(PRINTED), "open_loop": dict(TABLE["fprc"]),
             "closed_loop": dict(TABLE["fprc_pd"])}  # fmt: skip
    for key in keys:
        found[measure][key] *= factor
    return found


@pytest.mark.parametrize(
    ("count", "factor", "kept"),
    [(12, 1.07, True), (12, 1.09, False), (12, 0.91, False), (5, 1.24, True), (1, 1.26, False)],
)
def test_rig_is_kept_whose_errors_are_near_print(count, factor, kept):
    keys = list(printed_errors(PRINTED))[:count]
    assert fits(judged("errors", keys, factor), PRINTED) is kept


def test_rig_on_which_feedback_does_not_help_everywhere_is_left_out():
    assert fits(judged(), PRINTED)
    assert not fits(judged("closed_loop", ["complex"], 3.0), PRINTED)


def test_ensemble_has_the_rigs_that_fit(settings, monkeypatch):
    """Every other rig fits, so twice as many are drawn as are needed."""
    kept = []

    def full(on_rig, seed, **_):
        if seed % 2:
            return judged("errors", ["sweep/esn/test"], 2.0)
        kept.append([on_rig.rig["bending"][path.partition(".")[2]] for path in FREE])
        return judged()

    monkeypatch.setattr(fit, "judge_fully", full)
    found = Fit(PRINTED, **settings).ensemble(4)
    assert (found["parameters"], found["rigs"]) == (FREE, kept)
    assert len(kept) == 4
    monkeypatch.setattr(fit, "fits", lambda *_: False)
    with pytest.raises(EvaluationError, match="0 of 40"):
        Fit(PRINTED, **settings).ensemble(4)
