import importlib
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from fprc.artifacts import read_json, write_json
from fprc.config import PUBLISHED, Settings, check
from fprc.config.rig import Rig
from fprc.errors import EvaluationError, SimulationError
from fprc.experiments.comparison import compare_models
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import Judgement, RigSettings
from fprc.experiments.tracking import Track, tracking_rmse
from fprc.provenance import hash_of
from fprc.studies.calibration import fit as stage
from fprc.studies.calibration import objective, surrogate
from fprc.studies.calibration.full_models import judge_fully
from fprc.studies.calibration.objective import TERMS, aim_of, deviations, printed_errors
from fprc.studies.calibration.rig_file import parameter_file
from fprc.studies.calibration.space import decode, encode, free_parameters, resolved
from fprc.studies.calibration.surrogate import LOOPS, MEASURES, judge_by_surrogate

pytestmark = pytest.mark.slow  # whole fits

PRINTED = yaml.safe_load(PUBLISHED.read_text(encoding="utf-8"))
RIG = Rig().model_dump(mode="json")
ROUNDS = 2
SEARCH = importlib.import_module("fprc.studies.calibration.search")


def rigs(rounds):
    """Return how many rigs a search judges: where rounds begin and end, neighbours, and steps."""
    return 1 + rounds * (1 + 3 + 18)


@pytest.fixture(scope="module", autouse=True)
def small_surrogate():
    with pytest.MonkeyPatch.context() as small:
        for name, value in (("STRIDE", 7), ("ESN_NODES", 8), ("RESTARTS", 1)):
            small.setattr(surrogate, name, value)
        yield


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
        "full_seeds": [41, 42],
        "taps": [4, 1],
        "fit": list(TERMS),
        "first": {"fit": [], "rounds": 1, "starts": 1},
        "passes": 1,
        "rounds": ROUNDS,
    }
    signals = {name: signal | {"duration_s": 8.0} for name, signal in found["experiments"].items()}
    signals["sweep"]["f_hz"] = [0.8, 1.0]  # whole loops in its first quarter
    tracking = found["tracking"]
    for name, described in tracking["references"].items():
        f_hz = [0.5, 1.0] if name == "sweep" else described["f_hz"]
        described |= {"f_hz": f_hz, "duration_s": 2.0, "settle_s": 0.5}
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
        "grids": {"epsilon": [0.1, 1.0], "n_c": [3, 1]},
        "tracking": tracking,
        "workers": 1,
        "version": "v",
    }


@pytest.fixture(scope="module")
def on_rig(settings):
    return RigSettings(**settings["on_rig"])


def with_calibration(settings, **changes):
    return {"calibration": settings["calibration"] | changes}


# --- logarithms at a point ------------------------------------------------------------------------


@pytest.fixture
def judge_of(on_rig):
    """Return a judge of rigs that differ from the default one in these parameters."""
    return lambda paths: stage.Judge(
        None, replace(on_rig, rig=RIG), free_parameters(paths), {}, {}, {}, {}
    )


@pytest.fixture
def logs_at(judge_of, monkeypatch):
    """Return the logarithms at a point whose coordinates are these parameters."""

    def call(point, paths, estimate=None):
        seen = []

        def judge(self, settings, centers):
            seen.append(settings)
            return estimate(settings) if estimate else [{"errors": {"a": 2.0, "b": 3.0}}]

        monkeypatch.setattr(stage.Judge, "estimate", judge)
        return judge_of(paths).numbers(np.array(point), np.array(point), key="k"), seen

    return call


def test_rig_that_breaks_a_rule_is_impossible_and_not_simulated(logs_at):
    stiff = [f"reservoir.slip_distance_ml.{k}" for k in range(3)]
    stiff += ["reservoir.friction_kpa", "reservoir.friction_per_kpa"]
    point = [0.0, 0.0, 0.0, 1.0, 1.0]
    rig = resolved(decode(point, RIG, free_parameters(stiff)))
    with pytest.raises(ValueError, match="squeeze_damping"):
        Rig.model_validate(rig)
    assert logs_at(point, stiff) == (None, [])


@pytest.mark.parametrize(
    "failure", [SimulationError, np.linalg.LinAlgError, ValueError, EvaluationError]
)
def test_rig_that_cannot_be_judged_is_impossible(logs_at, failure):
    def fail(*_):
        raise failure("it failed")

    assert logs_at([0.5], ["drift.sigma_kpa"], fail)[0] is None


def test_clusterings_begin_at_those_of_the_rig_beside(judge_of, monkeypatch):
    """A stand-in whose only number is where its clustering began, twice at each rig."""

    def estimate(self, settings, centers):
        sigma_kpa = settings.rig["drift"]["sigma_kpa"]
        began = centers.setdefault(21, {}).setdefault("sweep", np.array([sigma_kpa]))
        return [{"errors": {"a": float(began[0])}}]

    monkeypatch.setattr(stage.Judge, "estimate", estimate)
    judge = judge_of(["drift.sigma_kpa"])
    for beside in (0.25, 0.75, 0.25):
        expected = decode(np.array([beside]), RIG, judge.free)["drift"]["sigma_kpa"]
        for point in (0.3, 0.9):
            found = judge.numbers(np.array([point]), np.array([beside]), key="beside")
            assert found == pytest.approx([math.log(expected)])


# --- the whole fit --------------------------------------------------------------------------------


def fit(folder, settings, **changes):
    folder.mkdir(exist_ok=True)
    how = settings | {"checkpoint": str(folder / "search.jsonl")} | changes
    rig, summary = stage.fit_rig(PRINTED, RigSettings(**how.pop("on_rig")), **how)
    write_json(folder / "fit.json", summary)
    began = {"to": [], "start": [], "seeds": []}
    (folder / "rig.yaml").write_text(parameter_file(rig, summary, "rig", began), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def fitted(settings, tmp_path_factory):
    return fit(tmp_path_factory.mktemp("fitted"), settings)


@pytest.fixture(scope="module")
def report(fitted):
    return read_json(fitted / "fit.json")


@pytest.fixture(scope="module")
def remeasured(fitted, report, settings, on_rig):
    """Return what the surrogate measures on the fitted rig, with the ratios of the report."""
    seed = judge_by_surrogate(
        replace(on_rig, rig=written(fitted)), 21, MEASURES, {},
        models=settings["judgement"]["models"], tracking=settings["tracking"],
        grids=settings["grids"] | {"taps": settings["calibration"]["taps"]},
    )  # fmt: skip
    for measure, ratios in report["surrogate_ratios"].items():
        for key, ratio in ratios.items():
            seed[measure][key] *= ratio
    return seed


def written(fitted):
    """Return the rig of the parameter file and of the configuration's defaults."""
    text = (fitted / "rig.yaml").read_text(encoding="utf-8")
    return check(yaml.safe_load(text)).rig.model_dump(mode="json")


def test_fit_improves_the_loss(report):
    assert report["loss"] < report["loss_at_start"]
    assert report["rounds"] == ROUNDS


def test_loss_of_the_report_is_that_of_its_terms_on_the_fitted_rig(report, remeasured, settings):
    aim = aim_of(PRINTED, settings["calibration"])
    assert report["fit"] == list(TERMS) == list(report["terms"])
    for name, found in report["terms"].items():
        (own,) = deviations([remeasured], aim._replace(fit=(name,))).values()
        expected = float(np.sum(own**2))
        assert found == pytest.approx(expected, rel=1e-9), name
    assert report["loss"] == pytest.approx(sum(report["terms"].values()), rel=1e-9)


def test_report_and_file_are_of_the_same_rig(fitted, report, settings):
    free = free_parameters(*(settings["calibration"][key] for key in ("free", "ranges")))
    shares = np.array([parameter["share"] for parameter in report["parameters"]])
    assert written(fitted) == decode(shares, settings["on_rig"]["rig"], free)
    assert [(p["path"], p["low"], p["high"]) for p in report["parameters"]] == [
        tuple(parameter) for parameter in free
    ]
    began_at = [parameter["began_at"] for parameter in report["parameters"]]
    assert began_at == encode(settings["on_rig"]["rig"], free).tolist()
    assert report["rig_sha256"] == hash_of(written(fitted))


@pytest.fixture(scope="module")
def full(settings):
    """Return what the full models measure on a rig, means over their seeds."""

    def call(on_rig):
        measures = {"shares", *LOOPS}
        seeds = judge_fully(
            on_rig, [41, 42], 1, settings["judgement"], settings["tracking"], measures
        )
        return {
            measure: {key: np.mean([seed[measure][key] for seed in seeds]) for key in errors}
            for measure, errors in seeds[0].items()
        }

    return call


def test_residuals_are_those_of_the_full_models_on_the_fitted_rig(fitted, report, full, on_rig):
    found = full(replace(on_rig, rig=written(fitted)))
    loops = PRINTED["table_4_tracking_rmse_deg"]
    printed = {
        "errors": printed_errors(PRINTED), "open_loop": loops["fprc"],
        "closed_loop": loops["fprc_pd"], "shares": {"p_o_over_theta_d": 56.1 / 43.8},
    }  # fmt: skip
    for measure, residuals in report["residuals"].items():
        expected = {key: found[measure][key] / printed[measure][key] - 1.0 for key in residuals}
        assert residuals == pytest.approx(expected, rel=1e-9)
        assert set(residuals) == set(found[measure])
    deviations = np.abs(list(report["residuals"]["errors"].values()))
    assert report["median_deviation"] == pytest.approx(np.median(deviations))
    assert report["largest_deviation"] == pytest.approx(deviations.max())


def test_surrogate_is_corrected_by_its_ratios_on_the_fitted_rig(
    fitted, report, settings, full, on_rig
):
    models, on_rig = settings["judgement"]["models"], replace(on_rig, rig=written(fitted))
    measures = {"shares", *LOOPS}
    cheap = judge_by_surrogate(
        on_rig, 21, measures, {}, models=models, grids={},
        tracking=settings["tracking"],
    )  # fmt: skip
    assert set(report["surrogate_ratios"]) == {"errors", *measures}
    for measure, errors in full(on_rig).items():
        expected = {key: error / cheap[measure][key] for key, error in errors.items()}
        assert report["surrogate_ratios"][measure] == pytest.approx(expected, rel=1e-9)


def test_share_and_loops_of_the_full_models_are_those_of_the_workflow(settings, on_rig):
    """C8a judges this share, and Table IV has these errors: FPRC of its best fold."""
    judgement, tracking = settings["judgement"], settings["tracking"]
    (judged,) = judge_fully(on_rig, [41], 1, judgement, tracking, {"shares", *LOOPS})
    compared, models = compare_models(simulate(on_rig, 41), Judgement(**judgement, seed=41))
    mean_share = compared["weights"]["mean_share"]
    expected = mean_share["p_o"] / mean_share["theta_d"]
    assert judged["shares"]["p_o_over_theta_d"] == pytest.approx(expected, rel=1e-9)
    settle_s = tracking["references"]["sweep"]["settle_s"]
    for loop, gains in (("closed_loop", 1.0), ("firm_loop", 1.5)):
        pd = {name: gains * value for name, value in on_rig.control["pd"].items()}
        bench = Track(tracking, {**on_rig.control, "pd": pd}, on_rig.rig, 41)
        run = bench.follow("sweep", ["fprc_pd"], models)["fprc_pd"]
        assert judged[loop]["sweep"] == pytest.approx(tracking_rmse(run, settle_s), rel=1e-6)
    assert judged["firm_loop"]["sweep"] != judged["closed_loop"]["sweep"]


@pytest.fixture
def judged(monkeypatch):
    """Points in the order in which the search asks for them."""
    found = SimpleNamespace(points=[])
    numbers = stage.Judge.numbers

    def noting(self, point, beside, key):
        found.points.append(tuple(np.asarray(point).tolist()))
        return numbers(self, point, beside, key)

    monkeypatch.setattr(stage.Judge, "numbers", noting)
    return found


class Quick:
    """A fit without simulations: all errors deviate from print by what a function of the rig says.

    A deviation of 1 is a factor of 1.05.
    """

    def __init__(self, monkeypatch, settings):
        calibration = settings["calibration"] | {"fit": ["tables"]}
        self.settings = settings | {"calibration": calibration}
        self.aim = aim_of(PRINTED, calibration)
        self.free = free_parameters(calibration["free"], calibration["ranges"])
        self.start = encode(settings["on_rig"]["rig"], self.free)
        self.deviation = lambda point, seeds: 1.0 + float(np.sum((point - self.start) ** 2))
        self.angle_deg = lambda point: 60.0
        monkeypatch.setattr(SEARCH, "_WORTH", -math.inf)  # no round is the last before its time
        monkeypatch.setattr(SEARCH, "_FAILED", 7)  # every round takes as many
        monkeypatch.setattr(
            stage.Judge, "estimate",
            lambda judge, on_rig, centers=None: self.judge(on_rig, judge.calibration["seeds"]),
        )  # fmt: skip
        monkeypatch.setattr(stage, "judge_fully", self.judge_fully)

    def loss(self, deviation):
        """Return the loss of a deviation."""
        judged = [{"errors": {key: value * math.exp(0.05 * deviation)
                              for key, value in self.aim.printed["errors"].items()}}]  # fmt: skip
        return float(np.sum(deviations(judged, self.aim)["tables"] ** 2))

    def errors(self, on_rig, seeds):
        point = encode(on_rig.rig, self.free)
        factor = math.exp(0.05 * self.deviation(point, list(seeds)))
        return {key: factor * value for key, value in self.aim.printed["errors"].items()}

    def judge(self, on_rig, seeds):
        properties = {"angle_deg": self.angle_deg(encode(on_rig.rig, self.free))}
        return [{"errors": self.errors(on_rig, seeds), "properties": properties} for _ in seeds]

    def judge_fully(self, on_rig, seeds, **rest):
        return [{"errors": self.errors(on_rig, seeds)} for _ in seeds]

    def fit(self, folder, **changes):
        return read_json(fit(folder, self.settings, **changes) / "fit.json")


@pytest.fixture
def quick(monkeypatch, settings):
    return Quick(monkeypatch, settings)


@pytest.mark.parametrize(("slope", "warned"), [(0.3, False), (-0.3, True)])
def test_rig_from_which_the_full_models_are_farther_than_from_the_start_is_warned_of(
    quick, tmp_path, caplog, monkeypatch, slope, warned
):
    """The start does not bend enough, and the errors pay for it or gain."""
    monkeypatch.setattr(objective, "PLAUSIBLE", {"angle_deg": (50.0, 70.0)})
    quick.deviation = lambda point, seeds: 1.0 + slope * np.sum(point - quick.start)
    quick.angle_deg = lambda point: 40.0 - 20.0 * np.sum(point - quick.start)
    with caplog.at_level("WARNING", logger="fprc"):
        found = quick.fit(tmp_path, **with_calibration(quick.settings, fit=["tables", "plausible"]))
    assert found["loss"] < found["loss_at_start"]
    assert found["full_seeds"] == [41, 42]
    assert (found["median_deviation"] > found["median_deviation_at_start"]) is warned
    assert any("closer to Tables II and III" in text for text in caplog.messages) is warned


def test_search_for_all_terms_begins_where_the_first_one_ended_and_where_it_began(
    quick, judged, tmp_path, monkeypatch
):
    asked = []
    estimate = stage.Judge.estimate

    def noting(judge, *given):
        asked.append((tuple(judge.calibration["fit"]), tuple(judge.calibration["seeds"])))
        return estimate(judge, *given)

    monkeypatch.setattr(stage.Judge, "estimate", noting)
    monkeypatch.setattr(objective, "PLAUSIBLE", {"angle_deg": (50.0, 70.0)})
    quick.deviation = lambda point, seeds: 1.0 + 0.3 * np.sum(point)
    first = {"fit": ["tables"], "rounds": 3, "starts": 2}
    changes = with_calibration(
        quick.settings, first=first, fit=["tables", "plausible"], rounds=4, seeds=[21, 22],
    )  # fmt: skip
    found = quick.fit(tmp_path, **changes)
    assert [search["rounds"] for search in found["searches"]] == [2 + 1 + 1, 2 + 1 + 1 + 1]
    assert found["rounds"] == 4 + 5
    counts = [4 * (3 + 18), 5 * (3 + 18)]
    # and where rounds begin and end
    assert found["evaluations"] == sum(counts) + (2 + 2 + 1 + 1) + (2 + 2 + 1 + 1 + 1)
    assert len(judged.points) == sum(counts)
    before, after = np.split(np.array(judged.points), counts[:1])
    # a neighbour of a start differs from it in one parameter only
    begun = [np.median(after[at : at + 3], axis=0) for at in (0, 3 + 18)]
    assert begun[0] == pytest.approx(before[before.sum(axis=1).argmin()], abs=1e-12)
    assert begun[1].tolist() == quick.start.tolist()
    assert found["fit"] == ["tables", "plausible"]
    assert found["loss_at_start"] == pytest.approx(
        quick.loss(1.0 + 0.3 * quick.start.sum()), rel=1e-3
    )
    assert [p["began_at"] for p in found["parameters"]] == quick.start.tolist()
    order = [fit for fit, before in zip(asked, [None, *asked], strict=False) if fit != before]
    assert order == [(("tables",), (21,)), (("tables", "plausible"), (21, 22))]
    quick.fit(tmp_path, **changes)
    assert len(judged.points) == sum(counts)


def test_passes_take_turns_with_the_seeds_and_one_that_finds_nothing_keeps_the_rig(
    quick, judged, tmp_path, monkeypatch
):
    """With the second seed first, as in the second pass, a search finds nothing near."""
    quick.deviation = lambda point, seeds: (
        1.5 if seeds[0] == 22 else 2.0 + np.sum(point - quick.start)
    )
    changes = {"first": {"fit": ["tables"], "rounds": 1, "starts": 1}, "seeds": [21, 22]}
    changes |= {"rounds": 1}
    ends = []
    for passes in (1, 2):
        (tmp_path / str(passes)).mkdir()
        judged.points.clear()
        settings = with_calibration(quick.settings, **changes, passes=passes)
        found = quick.fit(tmp_path / str(passes), **settings)
        ends.append((found["loss"], [p["share"] for p in found["parameters"]]))
        assert len(found["searches"]) == 2 * passes
    assert ends[0][1] == pytest.approx(ends[1][1], abs=1e-12)
    assert max(loss for loss, _ in ends) < 1e-6
