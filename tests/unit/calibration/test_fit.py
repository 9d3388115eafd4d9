import copy
import importlib
import re
from dataclasses import replace
from itertools import chain, pairwise, repeat
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from hypothesis import strategies as st
from pydantic import ValidationError

from fprc.artifacts import read_json
from fprc.calibration import decode, encode
from fprc.calibration import fit as stage
from fprc.config import Settings, check, reference
from fprc.config.rig import Rig
from fprc.errors import ConfigError, EvaluationError, SimulationError
from fprc.experiments.settings import RigSettings
from fprc.provenance import hash_of
from fprc.stages.calibrate import calibrate

ROOT = Path(__file__).parents[3]
PUBLISHED = ROOT / "config/published.yaml"
PRINTED = yaml.safe_load(PUBLISHED.read_text(encoding="utf-8"))
RIG = Rig().model_dump(mode="json")
PATHS = Settings().calibration.free
FREE = stage.free_parameters(PATHS)
SURROGATE = {"stride": 7, "esn_nodes": 8}

points = st.lists(st.floats(0.0, 1.0), min_size=len(FREE), max_size=len(FREE)).map(np.array)


# --- free parameters ------------------------------------------------------------------------------


def documented():
    """Return default and range of every number of the rig, as the reference page has them."""
    found = {}
    for part in reference.reference().split("\n## ")[1:]:
        section, _, table = part.partition("\n")
        if not section.startswith("rig"):
            continue
        for row in re.findall(r"^\| `(\w+)` \|[^|]*\| `(.*?)` \| (\S+) to (\S+) \|", table, re.M):
            name, default, low, high = row
            path = f"{section}.{name}".removeprefix("rig.")
            found[path] = yaml.safe_load(default), float(low), float(high)
    return found


RANGES = documented()
NUMBERS = [path for path, (default, *_) in RANGES.items() if not isinstance(default, list)]
LISTS = [path for path, (default, *_) in RANGES.items() if isinstance(default, list)]


def test_reference_has_every_number_of_the_rig():
    def names(section, prefix=""):
        for key, value in section.items():
            if isinstance(value, dict):
                yield from names(value, f"{prefix}{key}.")
            else:
                yield prefix + key

    assert set(RANGES) == set(names(RIG))
    assert LISTS


@pytest.mark.parametrize("path", NUMBERS)
def test_range_of_a_number_is_that_of_the_configuration(path):
    (free,) = stage.free_parameters([path])
    assert free.path == path
    assert (free.low, free.high) == pytest.approx(RANGES[path][1:], rel=1e-5)


@pytest.mark.parametrize("path", LISTS)
def test_range_of_a_number_of_a_list_is_that_of_the_list(path):
    default, *limits = RANGES[path]
    paths = [f"{path}.{index}" for index in range(len(default))]
    for free, known in zip(stage.free_parameters(paths), paths, strict=True):
        assert free.path == known
        assert (free.low, free.high) == pytest.approx(limits, rel=1e-5)


@pytest.mark.parametrize("path", LISTS)
def test_range_of_a_list_is_as_wide_as_all_of_its_numbers_allow(path):
    default, low, high = RANGES[path]
    free = stage.free_parameters([path])
    ends = {
        share: np.array(stage_value(decode(np.array([share]), RIG, free, digits=12), path))
        for share in (0.0, 1.0)
    }
    assert ends[0.0].min() == pytest.approx(low, abs=1e-9)
    assert ends[1.0].max() == pytest.approx(high)
    for found in ends.values():
        assert (found >= low - 1e-9).all()
        assert (found <= high + 1e-9).all()


def stage_value(rig, path):
    for key in path.split("."):
        rig = rig[key]
    return rig


def test_default_rig_is_in_the_middle_of_its_ranges():
    assert decode(encode(RIG, FREE), RIG, FREE) == RIG
    assert len({free.path for free in FREE}) == len(FREE)


def test_narrower_range_replaces_the_physical_one():
    free = stage.free_parameters(
        ["drift.time_s", "bending.slip_distance_deg", "drift.sigma_kpa"],
        {"drift.time_s": [2, 3.5], "bending.slip_distance_deg": [0.5, 1.5]},
    )
    assert [(parameter.low, parameter.high) for parameter in free] == [
        (2.0, 3.5), (0.5, 1.5), (0.0, 15.0),
    ]  # fmt: skip


def test_physical_range_is_a_range_too():
    (free,) = stage.free_parameters(["drift.time_s"], {"drift.time_s": [1.0, 60.0]})
    assert (free.low, free.high) == (1.0, 60.0)


@pytest.mark.parametrize("limits", [(5.0, 5.0), (6.0, 5.0), (0.9, 5.0), (5.0, 60.1), (-1.0, 99.0)])
def test_range_that_is_empty_or_leaves_the_physical_one_is_refused(limits):
    with pytest.raises(ConfigError, match=r"drift\.time_s is .* within 1 to 60"):
        stage.free_parameters(["drift.time_s"], {"drift.time_s": limits})


def test_all_paths_and_ranges_that_are_wrong_are_reported_at_once():
    wrong = ["bending", "bending.friciton_kpa", "models.esn.r", "bending.relaxation_time_s.-1"]
    ranges = {"bending.preload_kpa": [30.0, 40.0], "drift.time_s": [3.0, 2.0]}
    with pytest.raises(ConfigError) as caught:
        stage.free_parameters(["bending.friction_kpa", *wrong, "drift.time_s"], ranges)
    first, *lines = str(caught.value).splitlines()
    assert first == "cannot calibrate:"
    assert sorted(line.split(" is ")[0].strip() for line in lines) == sorted(
        [
            *(f"calibration.free: {path}" for path in wrong),
            *(f"calibration.ranges: {path}" for path in ranges),
        ]
    )


@pytest.mark.parametrize("path", ["bending.relaxation_time_s.2", "bending.friction_kpa.0"])
def test_index_that_is_not_there_is_reported(path):
    with pytest.raises(ConfigError, match=re.escape(path)):
        stage.free_parameters([path])


def test_range_of_a_parameter_that_is_not_free_any_more_can_be_taken_away():
    changed = {"free": ["drift.sigma_kpa", "drift.time_s"], "ranges": {}}
    calibration = check({"calibration": changed}).calibration
    assert stage.free_parameters(calibration.free, calibration.ranges)


# --- target ---------------------------------------------------------------------------------------


def test_target_is_the_training_and_test_errors_of_tables_2_and_3():
    calibration = Settings().calibration.model_dump(mode="json")
    aim = stage.aim_of(PRINTED, calibration)
    assert aim.errors == {
        "sweep/esn/train": 11.5, "sweep/esn/test": 16.5,
        "sweep/fprc/train": 11.6, "sweep/fprc/test": 11.0,
        "sweep/fuzzy_linear/train": 14.9, "sweep/fuzzy_linear/test": 16.7,
        "complex/esn/train": 10.2, "complex/esn/test": 60.32,
        "complex/fprc/train": 9.07, "complex/fprc/test": 26.2,
        "complex/fuzzy_linear/train": 13.5, "complex/fuzzy_linear/test": 51.5,
    }  # fmt: skip
    assert aim.ranges == calibration["plausible"]
    assert (aim.margin, aim.ratio) == (calibration["margin"], calibration["ratio"])


def test_target_follows_the_published_file():
    printed = copy.deepcopy(PRINTED)
    printed["table_3_reversed"]["esn"] |= {"train_rmse_kpa": [1.5, 9.0], "test_rmse_kpa": 2.5}
    aim = stage.aim_of(printed, {"plausible": {}, "margin": 0.0, "ratio": 1.0})
    assert (aim.errors["complex/esn/train"], aim.errors["complex/esn/test"]) == (1.5, 2.5)


# --- tiny configuration ---------------------------------------------------------------------------


@pytest.fixture(scope="module")
def settings():
    """What the stage takes, with short signals and small models."""
    found = Settings().model_dump(mode="json")
    models = found["models"] | {"n_y": 2}
    models["esn"] |= {"r": 12, "washout": 10}
    models["fprc"] |= {"n_c": 2, "n_u": 2}
    calibration = found["calibration"] | {
        "free": ["bending.friction_kpa", "bending.friction_per_kpa", "drift.sigma_kpa"],
        "ranges": {"drift.sigma_kpa": [0.5, 14.5]},
        "seeds": [21],
        "check_seeds": [41],
        "population": 4,
        "generations": 2,
        "stride": 7,
        "esn_nodes": 8,
        "step": 0.3,
    }
    signals = {name: signal | {"duration_s": 8.0} for name, signal in found["experiments"].items()}
    signals["sweep"]["f_start_hz"] = 0.8  # whole loops in its first quarter
    rig = found["rig"]
    # far from the paper, so that there is something to improve
    rig["bending"] |= {"friction_kpa": 14.0, "friction_per_kpa": 0.19}
    rig["drift"]["sigma_kpa"] = 14.0
    return {
        "on_rig": {
            "rig": rig,
            "signals": signals,
            "control": found["control"],
            "target": "command",
        },
        "judgement": {"models": models, "folds": 2, "split": "shuffled"},
        "calibration": calibration,
        "workers": 1,
        "version": "v",
    }


@pytest.fixture(scope="module")
def on_rig(settings):
    return RigSettings(**settings["on_rig"])


@pytest.fixture
def loss_of_point(settings, on_rig):
    """Return the loss of a point whose coordinates are these parameters."""

    def call(point, paths, **changes):
        aim = stage.aim_of(PRINTED, settings["calibration"])
        arguments = {
            "on_rig": replace(on_rig, rig=RIG),
            "free": stage.free_parameters(paths),
            "seeds": [21, 22],
            "aim": aim,
            "ratios": dict.fromkeys(aim.errors, 1.0),
            "models": settings["judgement"]["models"],
            "surrogate": SURROGATE,
        }
        return stage.loss_at(np.array(point), **arguments | changes)

    return call


# --- loss of a point ------------------------------------------------------------------------------

STIFF = ["reservoir.squeeze_damping_kpa_s_per_ml", "reservoir.slip_distance_ml"]


def test_rig_that_breaks_a_rule_is_impossible_and_not_simulated(loss_of_point, monkeypatch):
    rig = decode(np.zeros(2), RIG, stage.free_parameters(STIFF))
    with pytest.raises(ValidationError, match="squeeze covers"):
        Rig.model_validate(rig)
    monkeypatch.setattr(stage, "judge_cheaply", None)
    assert loss_of_point([0.0, 0.0], STIFF) == stage.IMPOSSIBLE


def test_possible_rig_costs_less_than_an_impossible_one(loss_of_point):
    assert 0.0 < loss_of_point([0.5], ["drift.sigma_kpa"]) < stage.IMPOSSIBLE


def judged_as(monkeypatch, factor=1.0, found=None, failure=None):
    """Replace the surrogate: errors are the printed ones by a factor, properties in the middle."""

    def judge(on_rig, seed, models, surrogate):
        if failure is not None:
            raise failure
        aim = stage.aim_of(PRINTED, Settings().calibration.model_dump())
        middle = {name: np.sqrt(low * high) for name, (low, high) in aim.ranges.items()}
        return {key: factor * value for key, value in aim.errors.items()}, middle | (found or {})

    monkeypatch.setattr(stage, "judge_cheaply", judge)


def test_ratios_correct_the_stand_in(loss_of_point, monkeypatch):
    judged_as(monkeypatch, factor=0.5)
    aim = stage.aim_of(PRINTED, Settings().calibration.model_dump())
    twice = dict.fromkeys(aim.errors, 2.0)
    assert loss_of_point([0.5], ["drift.sigma_kpa"], ratios=twice) == pytest.approx(0.0)
    assert loss_of_point([0.5], ["drift.sigma_kpa"]) == pytest.approx(np.log(2.0) ** 2)


@pytest.mark.parametrize("factor", [np.inf, np.nan])
def test_loss_that_is_not_finite_is_impossible(loss_of_point, monkeypatch, factor):
    judged_as(monkeypatch, factor=factor)
    assert loss_of_point([0.5], ["drift.sigma_kpa"]) == stage.IMPOSSIBLE


@pytest.mark.parametrize(
    "failure",
    [
        SimulationError("the bending angle left its physical range"),
        np.linalg.LinAlgError("singular matrix"),
        ValueError("input contains NaN"),
        EvaluationError("the model's output is not finite"),
    ],
    ids=lambda failure: type(failure).__name__,
)
def test_rig_that_cannot_be_judged_is_impossible(loss_of_point, monkeypatch, failure):
    judged_as(monkeypatch, failure=failure)
    assert loss_of_point([0.5], ["drift.sigma_kpa"]) == stage.IMPOSSIBLE


def test_rig_that_diverges_is_impossible(loss_of_point, on_rig):
    # as soft as can be, and pressed as hard as can be: it bends by more than half a turn
    soft = [
        "bending.stiffness_kpa_per_deg", "bending.cubic_stiffness_kpa_per_deg3",
        "bending.relaxation_stiffness_kpa_per_deg", "bending.preload_kpa",
        "bending.friction_per_kpa",
    ]  # fmt: skip
    hard = {"amplitude_kpa": 225.0, "offset_kpa": 230.0, "f_start_hz": 0.3}
    signals = {
        name: signal | (hard if name == "sweep" else {}) | {"duration_s": 4.0}
        for name, signal in on_rig.signals.items()
    }
    changed = RigSettings(RIG, on_rig.control, signals, on_rig.target)
    assert loss_of_point(np.zeros(5), soft, on_rig=changed) == stage.IMPOSSIBLE


# --- the whole fit --------------------------------------------------------------------------------

#: Losses at the end of a fit: on its seeds at the start, and on other seeds there and at the end.
AFTERWARDS = 3


def fit(folder, settings, **changes):
    folder.mkdir(exist_ok=True)
    paths = [str(folder / name) for name in ("rig.yaml", "fit.json")]
    calibrate(
        str(PUBLISHED), *paths, **settings | {"checkpoint": str(folder / "search.jsonl")} | changes
    )
    return folder


@pytest.fixture(scope="module")
def fitted(settings, tmp_path_factory):
    return fit(tmp_path_factory.mktemp("fitted"), settings)


@pytest.fixture(scope="module")
def report(fitted):
    return read_json(fitted / "fit.json")


def written(fitted):
    """Return the rig of the parameter file and of the configuration's defaults."""
    text = (fitted / "rig.yaml").read_text(encoding="utf-8")
    return check(yaml.safe_load(text)).rig.model_dump(mode="json")


def test_fit_improves_the_loss(report):
    assert report["loss"] < report["loss_at_start"]
    assert report["finished"] is True
    assert (report["generations"], report["evaluations"]) == (2, 8)


def test_report_and_file_are_of_the_same_rig(fitted, report, settings):
    free = stage.free_parameters(*(settings["calibration"][key] for key in ("free", "ranges")))
    shares = np.array([parameter["share"] for parameter in report["parameters"]])
    assert written(fitted) == decode(shares, settings["on_rig"]["rig"], free)
    assert [(p["path"], p["low"], p["high"]) for p in report["parameters"]] == [
        tuple(parameter) for parameter in free
    ]
    began_at = [parameter["began_at"] for parameter in report["parameters"]]
    assert began_at == encode(settings["on_rig"]["rig"], free).tolist()
    assert report["rig_sha256"] == hash_of(written(fitted))


def test_only_free_parameters_are_changed(fitted, settings):
    found, before = written(fitted), copy.deepcopy(settings["on_rig"]["rig"])
    for path in settings["calibration"]["free"]:
        section, name = path.split(".")
        assert found[section][name] != before[section][name]
        before[section][name] = found[section][name]
    assert found == before


def test_residuals_are_those_of_the_full_models_on_the_fitted_rig(fitted, report, settings, on_rig):
    best = replace(on_rig, rig=written(fitted))
    (errors,) = stage.full_errors(best, [21], 1, settings["judgement"])
    aim = stage.aim_of(PRINTED, settings["calibration"])
    expected = {key: errors[key] / aim.errors[key] - 1.0 for key in aim.errors}
    assert report["residuals"] == pytest.approx(expected, rel=1e-9)
    deviations = np.abs(list(expected.values()))
    assert report["median_deviation"] == pytest.approx(np.median(deviations))
    assert report["largest_deviation"] == pytest.approx(deviations.max())
    assert report["targets_kpa"] == aim.errors


def test_stand_in_is_corrected_by_its_ratios_on_the_rig_at_the_start(report, settings, on_rig):
    judgement = settings["judgement"]
    (full,) = stage.full_errors(on_rig, [21], 1, judgement)
    cheap, _ = stage.judge_cheaply(on_rig, 21, judgement["models"], SURROGATE)
    expected = {key: full[key] / cheap[key] for key in full}
    assert report["standin_ratios"] == pytest.approx(expected, rel=1e-9)


def test_properties_of_the_report_are_those_of_the_fitted_rig(fitted, report, settings, on_rig):
    best = replace(on_rig, rig=written(fitted))
    _, found = stage.judge_cheaply(best, 21, settings["judgement"]["models"], SURROGATE)
    assert report["properties"] == pytest.approx(found, rel=1e-9)
    assert report["plausible"] == settings["calibration"]["plausible"]


def head_of(text):
    return [line for line in text.splitlines() if line.startswith("#")]


def test_head_of_the_fit_names_its_seed_and_its_residuals(fitted, report):
    head = "\n".join(head_of((fitted / "rig.yaml").read_text(encoding="utf-8")))
    assert "noise seeds 21:" in head
    for key, value in report["residuals"].items():
        assert f"{key}: {report['targets_kpa'][key]:g} kPa, {100 * value:+.1f} %" in head


def undated(folder):
    found = [(folder / name).read_text(encoding="utf-8") for name in ("rig.yaml", "fit.json")]
    return [re.sub(r"\d{4}-\d{2}-\d{2}", "", text) for text in found]


@pytest.fixture
def judged(monkeypatch):
    """Points in the order in which the search asks for them; stops before number ``stop``."""

    class Judge:
        def __init__(self):
            self.points, self.stop = [], None

        def __call__(self, point, **settings):
            if len(self.points) == self.stop:
                raise KeyboardInterrupt
            self.points.append(tuple(np.asarray(point).tolist()))
            return loss_at(point, **settings)

    loss_at = stage.loss_at
    spy = Judge()
    monkeypatch.setattr(stage, "loss_at", spy)
    return spy


def test_interrupted_fit_goes_on_where_it_was(fitted, settings, tmp_path, judged):
    judged.stop = 6
    with pytest.raises(KeyboardInterrupt):
        fit(tmp_path, settings)
    assert [path.name for path in tmp_path.iterdir()] == ["search.jsonl"]
    judged.points, judged.stop = [], None
    assert undated(fit(tmp_path, settings)) == undated(fitted)
    assert len(judged.points) == 4 + AFTERWARDS  # the second generation alone


def quickly(monkeypatch, loss, on_other_seeds=None):
    """Replace all that simulates; the losses become functions of the point."""
    aim = stage.aim_of(PRINTED, Settings().calibration.model_dump())
    errors = dict.fromkeys(aim.errors, 1.0)
    calls = []

    def loss_at(point, **settings):
        calls.append(tuple(np.asarray(point).tolist()))
        checks = on_other_seeds is not None and settings["seeds"] == [41]
        return (on_other_seeds if checks else loss)(np.asarray(point))

    monkeypatch.setattr(stage, "loss_at", loss_at)
    monkeypatch.setattr(stage, "judge_cheaply", lambda *arguments: (errors, {"angle_deg": 60.0}))
    monkeypatch.setattr(stage, "full_errors", lambda on_rig, seeds, *rest: [errors for _ in seeds])
    return calls


CHANGES = {
    "version": lambda s: {"version": "w"},
    "rig": lambda s: {"on_rig": s["on_rig"] | {"rig": s["on_rig"]["rig"] | {"step_s": 1e-4}}},
    "target": lambda s: {"on_rig": s["on_rig"] | {"target": "measured"}},
    "models": lambda s: {
        "judgement": s["judgement"] | {"models": s["judgement"]["models"] | {"alpha": 0.5}}
    },
    "folds": lambda s: {"judgement": s["judgement"] | {"folds": 3}},
    **{
        key: lambda s, key=key, value=value: {"calibration": s["calibration"] | {key: value}}
        for key, value in {
            "seeds": [21, 22],
            "stride": 8,
            "esn_nodes": 9,
            "margin": 0.1,
            "ratio": 2.0,
            "plausible": {"angle_deg": [1.0, 2.0]},
            "free": ["bending.friction_kpa", "drift.sigma_kpa"],
            "ranges": {"drift.sigma_kpa": [0.5, 14.6]},
        }.items()
    },
}


@pytest.mark.parametrize("what", CHANGES)
def test_search_with_other_settings_begins_anew(settings, tmp_path, monkeypatch, what):
    calls = quickly(monkeypatch, lambda point: float(np.sum(point**2)))
    fit(tmp_path, settings)
    assert len(calls) == 8 + AFTERWARDS
    fit(tmp_path, settings)
    assert len(calls) == 8 + 2 * AFTERWARDS
    fit(tmp_path, settings, **CHANGES[what](settings))
    assert len(calls) == 8 + 8 + 3 * AFTERWARDS


def test_search_that_runs_out_of_time_is_reported_as_not_finished(settings, tmp_path, monkeypatch):
    calls = quickly(monkeypatch, lambda point: float(np.sum(point**2)))
    clock = SimpleNamespace(monotonic=lambda: float(len(calls)))  # a second for each rig
    monkeypatch.setattr(importlib.import_module("fprc.calibration.search"), "time", clock)
    calibration = settings["calibration"] | {"generations": 100, "minutes": 0.15}
    found = read_json(fit(tmp_path, settings, calibration=calibration) / "fit.json")
    assert (found["finished"], found["generations"], found["evaluations"]) == (False, 3, 12)


def test_worse_rigs_of_later_generations_do_not_replace_a_better_one(
    settings, tmp_path, monkeypatch
):
    losses = chain([3.0, 1.0, 2.0, 4.0, 5.0, 6.0, 7.0, 8.0], repeat(9.0))
    calls = quickly(monkeypatch, lambda point: next(losses))
    found = read_json(fit(tmp_path, settings) / "fit.json")
    assert found["loss"] == 1.0
    assert [parameter["share"] for parameter in found["parameters"]] == pytest.approx(calls[1])


def test_fit_is_no_worse_than_the_rig_that_it_began_at(settings, tmp_path, monkeypatch):
    free = stage.free_parameters(*(settings["calibration"][key] for key in ("free", "ranges")))
    start = encode(settings["on_rig"]["rig"], free)
    quickly(monkeypatch, lambda point: float(np.sum((point - start) ** 2)))
    found = read_json(fit(tmp_path, settings) / "fit.json")
    assert found["loss_at_start"] == 0.0
    assert found["loss"] <= found["loss_at_start"]


@pytest.mark.parametrize(("sign", "warned"), [(1.0, False), (-1.0, True)])
def test_rig_that_is_worse_on_other_seeds_than_the_one_before_it_is_warned_of(
    settings, tmp_path, monkeypatch, caplog, sign, warned
):
    def loss(point):
        return 10.0 + float(np.sum(point))

    quickly(monkeypatch, loss, lambda point: sign * loss(point))
    with caplog.at_level("WARNING", logger="fprc"):
        found = read_json(fit(tmp_path, settings) / "fit.json")
    assert found["loss"] < found["loss_at_start"]
    assert found["check_loss"] == pytest.approx(sign * found["loss"])
    assert found["check_loss_at_start"] == pytest.approx(sign * found["loss_at_start"])
    assert found["check_seeds"] == [41]
    assert any("keep the starting rig" in text for text in caplog.messages) is warned


def test_published_numbers_that_cannot_be_read_are_an_error(settings, tmp_path):
    broken = tmp_path / "broken.yaml"
    broken.write_text("a: [")
    for path in (tmp_path / "none.yaml", broken):
        with pytest.raises(ConfigError, match=re.escape(str(path))):
            calibrate(str(path), "x", "y", checkpoint="z", **settings)


def test_progress_of_the_search_is_logged(settings, tmp_path, monkeypatch, caplog):
    quickly(monkeypatch, lambda point: float(np.sum(point**2)))
    with caplog.at_level("INFO", logger="fprc"):
        fit(tmp_path, settings)
    generations = [text for text in caplog.messages if text.startswith("generation ")]
    least = [float(text.split("least loss ")[1].split(",")[0]) for text in generations]
    assert [text.split(",")[0] for text in generations] == [
        "generation 1 of 2", "generation 2 of 2",
    ]  # fmt: skip
    assert all(later <= earlier for earlier, later in pairwise(least))
