import copy
from dataclasses import replace

import numpy as np
import pytest
import yaml
from pydantic import ValidationError

from fprc.artifacts import read_json, write_json
from fprc.claims.finding import Results
from fprc.claims.ledger import judge_claims
from fprc.config import PUBLISHED, Settings
from fprc.config.rig import Rig
from fprc.control.loop import RunAbortedError
from fprc.errors import EvaluationError, FprcError, SimulationError
from fprc.experiments.comparison import compare_models
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import Judgement, RigSettings
from fprc.rig.simulator import draw_instruments
from fprc.studies.calibration.space import decode, encode, free_parameters
from fprc.studies.calibration.surrogate import judge_by_surrogate
from fprc.studies.families import ensemble
from fprc.studies.families.claims import JUDGED_BY_RIG
from fprc.studies.stages import ensemble as stage
from fprc.studies.stages.rigs import summarise_rigs

PATHS = [
    "bending.stiffness_kpa_per_deg",
    "bending.preload_kpa",
    "reservoir.squeeze_stiffness_kpa_per_ml",
]
RANGES = {"bending.stiffness_kpa_per_deg": [2.5, 4.0]}
FREE = free_parameters(PATHS, RANGES)
SEED = 1000
DIVERGED = SimulationError("simulated rig: the bending angle left its physical range")


@pytest.fixture(scope="module")
def settings():
    """What judging a rig takes, with short signals and small models."""
    found = Settings().model_dump(mode="json")
    signals = {name: signal | {"duration_s": 8.0} for name, signal in found["experiments"].items()}
    signals["sweep"]["f_start_hz"] = 0.8  # whole loops in its first quarter
    tracking = found["tracking"]
    for name, reference in tracking["references"].items():
        f_hz = [0.5, 1.0] if name == "sweep" else reference["f_hz"]
        reference |= {"f_hz": f_hz, "duration_s": 4.0, "settle_s": 0.5}
    tracking["pushes"] |= {"quiet_s": 1.5, "every_s": 0.2}
    models = found["models"] | {"n_y": 2}
    models["esn"] |= {"r": 12, "washout": 10}
    models["fprc"] |= {"n_c": 2, "n_u": 2}
    rig = {"rig": found["rig"], "signals": signals, "control": found["control"]}
    return {
        "on_rig": rig | {"target": "command"},
        "tracking": tracking,
        "judgement": {"models": models, "folds": 2, "split": "shuffled"},
    }


@pytest.fixture(scope="module")
def on_rig(settings):
    return RigSettings(**settings["on_rig"])


@pytest.fixture(scope="module")
def drawing():
    """What the draws are taken from."""
    return Settings().ensemble.model_dump(mode="json")


@pytest.fixture
def quickly(monkeypatch):
    """Judge rigs without models and closed loops; the results tell the rig by its numbers."""
    monkeypatch.setattr(
        ensemble, "compare_models",
        lambda data, how: (
            {"seed": how.seed, "theta": float(data["sweep"].channels["theta_deg"].sum())},
            {"fprc": f"FPRC of {how.seed}"},
        ),
    )  # fmt: skip
    monkeypatch.setattr(
        ensemble, "measure_control",
        lambda sweep, bench, models, controllers: {
            "seed": bench.seed, "stiffness": bench.rig["bending"]["stiffness_kpa_per_deg"],
            "theta": float(sweep.channels["theta_deg"].sum()), **models,
        },
    )  # fmt: skip


@pytest.fixture
def judge(tmp_path, settings, drawing):
    """Judge a chunk of rigs and return them."""

    def call(*numbers, name="rigs.json", version="v", **changes):
        stage.judge_rigs(
            str(tmp_path / name),
            numbers=list(numbers),
            ensemble=drawing | changes,
            free={"paths": PATHS, "ranges": RANGES},
            checkpoint=str(tmp_path / "partial.jsonl"),
            version=version,
            **settings,
        )
        found = read_json(tmp_path / name)
        assert found["source"] == "sim"
        return found["rigs"]

    return call


def rig_of(judged, on_rig):
    """Return the rig that the shares of a report stand for."""
    shares = np.array([judged["parameters"][path] for path in PATHS])
    return replace(on_rig, rig=decode(shares, on_rig.rig, FREE))


def sweep_of(on_rig, seed):
    """Return the channels of the sweep alone."""
    alone = replace(on_rig, signals={"sweep": on_rig.signals["sweep"]})
    return simulate(alone, seed)["sweep"].channels


# --- draws ----------------------------------------------------------------------------------------


@pytest.mark.usefixtures("quickly")
def test_rig_is_the_same_in_whatever_chunk_it_is(judge):
    together = judge(0, 1, 2)
    assert [rig["rig"] for rig in together] == [0, 1, 2]
    assert judge(2) == together[2:]
    assert judge(1, 0) == [together[1], together[0]]


@pytest.mark.usefixtures("quickly")
def test_rigs_differ_and_have_seeds_of_their_own(judge):
    rigs = judge(0, 1, 2, 3)
    assert [rig["seed"] for rig in rigs] == [SEED, SEED + 1, SEED + 2, SEED + 3]
    for path in PATHS:
        assert len({rig["parameters"][path] for rig in rigs}) == 4
    assert len({rig["compared"]["theta"] for rig in rigs}) == 4


@pytest.mark.usefixtures("quickly")
def test_all_parts_of_a_judgement_are_of_one_rig_and_one_seed(judge, on_rig):
    for rig in judge(0, 1):
        drawn = rig_of(rig, on_rig)
        theta = float(sweep_of(drawn, rig["seed"])["theta_deg"].sum())
        assert rig["compared"] == {"seed": rig["seed"], "theta": theta}
        assert rig["measured"] == {
            "seed": rig["seed"], "stiffness": drawn.rig["bending"]["stiffness_kpa_per_deg"],
            "theta": theta, "fprc": f"FPRC of {rig['seed']}",
        }  # fmt: skip


@pytest.fixture
def draw(on_rig, drawing):
    def call(seed=SEED, **changes):
        drawn, _, draws = ensemble.draw_rig(seed, drawing | changes, FREE, on_rig)
        return drawn, draws

    return call


def stream(seed):
    """Return the random numbers of a rig's parameters."""
    return np.random.default_rng([seed, 20241])


WIDE = {"angle_deg": (1.0, 120.0), "p_o_swing_kpa": (1.0, 400.0)}


def test_parameters_are_drawn_from_another_stream_than_sensors_and_noise(draw, on_rig):
    drawn, draws = draw(**WIDE)
    assert draws == 1
    others = [[SEED], *([SEED, run] for run in range(100)), [SEED, 4711]]
    for other in others:
        shares = np.random.default_rng(other).uniform(size=len(FREE))
        assert drawn.rig != decode(shares, on_rig.rig, FREE)
    assert drawn.rig == decode(stream(SEED).uniform(size=len(FREE)), on_rig.rig, FREE)


def test_parameters_and_errors_of_the_sensors_are_independent(draw, on_rig):
    seeds = range(60)
    shares = np.array([encode(draw(seed, **WIDE)[0].rig, FREE) for seed in seeds])
    instruments = [draw_instruments(on_rig.rig, np.random.default_rng([seed])) for seed in seeds]
    errors = np.array(
        [np.ravel([each[name] for name in ("gain", "offset", "bow")]) for each in instruments]
    )
    assert errors.shape == (60, 9)
    correlations = np.corrcoef(shares.T, errors.T)[: len(FREE), len(FREE) :]
    # chance exceeds this once in 20000
    assert np.abs(correlations).max() < 0.5


WINDOWS = {"angle_deg": (52.0, 66.0), "p_o_swing_kpa": (50.0, 85.0)}


@pytest.mark.parametrize("seed", range(3))
def test_first_plausible_draw_within_the_ranges_is_taken(draw, on_rig, seed):
    rng = stream(seed)
    (least, most), (weakest, strongest) = WINDOWS.values()
    drawn, draws = draw(seed, **WINDOWS)
    for number in range(1, draws + 1):
        rig = decode(rng.uniform(size=len(FREE)), on_rig.rig, FREE)
        log = sweep_of(replace(on_rig, rig=rig), seed)
        bends = least <= log["theta_deg"].max() <= most
        squeezes = weakest <= np.ptp(log["p_o_kpa"]) <= strongest
        assert bool(bends and squeezes) is (number == draws)
    assert drawn == replace(on_rig, rig=rig)
    Rig.model_validate(drawn.rig)
    assert 2.5 <= drawn.rig["bending"]["stiffness_kpa_per_deg"] <= 4.0
    assert 20.0 <= drawn.rig["bending"]["preload_kpa"] <= 77.0
    assert 5.0 <= drawn.rig["reservoir"]["squeeze_stiffness_kpa_per_ml"] <= 150.0


@pytest.mark.parametrize(
    "failure",
    [
        DIVERGED,
        EvaluationError("a loop cannot be measured"),
        RunAbortedError("run stopped at sample 3: it diverged", {}),
    ],
    ids=lambda failure: type(failure).__name__,
)
def test_draw_that_cannot_be_simulated_is_thrown_away(draw, monkeypatch, failure):
    """The second draw is then the first that is looked at."""
    failures = [failure]

    def simulate_once(*arguments):
        if failures:
            raise failures.pop()
        return simulate(*arguments)

    first, _ = draw(**WIDE)
    monkeypatch.setattr(ensemble, "simulate", simulate_once)
    second, draws = draw(**WIDE)
    assert draws == 2
    assert second != first


def test_draw_that_breaks_a_rule_is_thrown_away(on_rig):
    narrow = {
        "reservoir.squeeze_damping_kpa_s_per_ml": [0.3, 2.0],
        "reservoir.slip_distance_ml": [0.01, 0.05],
    }
    free = free_parameters(list(narrow), narrow)
    rng, broken = stream(2), 0
    while breaks_a_rule(decode(rng.uniform(size=2), on_rig.rig, free)):
        broken += 1
    drawn, shares, draws = ensemble.draw_rig(2, WIDE, free, on_rig)
    assert drawn.rig == decode(shares, on_rig.rig, free)
    assert not breaks_a_rule(drawn.rig)
    assert draws == broken + 1 > 1


def breaks_a_rule(rig):
    try:
        Rig.model_validate(rig)
    except ValidationError:
        return True
    return False


def test_windows_that_no_rig_fits_into_are_an_error(draw, monkeypatch):
    monkeypatch.setattr(ensemble, "_MOST_DRAWS", 3)
    with pytest.raises(EvaluationError, match=r"none of 3 rigs bends by \(1.0, 2.0\) deg"):
        draw(angle_deg=(1.0, 2.0))


# --- judgement ------------------------------------------------------------------------------------


def test_rig_that_cannot_be_judged_is_reported_and_the_next_one_still_judged(
    judge, monkeypatch, quickly
):
    compare = ensemble.compare_models

    def fail(data, how):
        if how.seed == SEED + 1:
            raise EvaluationError("the model's output is not finite")
        return compare(data, how)

    expected = judge(0, 1, 2)
    monkeypatch.setattr(ensemble, "compare_models", fail)
    first, second, third = judge(0, 1, 2)
    assert (first, third) == (expected[0], expected[2])
    del expected[1]["compared"], expected[1]["measured"]
    assert second == expected[1] | {"failed": "the model's output is not finite"}


@pytest.fixture
def judged(monkeypatch):
    """Numbers of the rigs that are judged; stops before rig ``judged.stop``."""

    def judge_rig(cell, **settings):
        if cell["rig"] == judge_rig.stop:
            raise KeyboardInterrupt
        judge_rig.numbers.append(cell["rig"])
        return {"seed": settings["ensemble"]["seed"] + cell["rig"]}

    judge_rig.numbers, judge_rig.stop = [], None
    monkeypatch.setattr(stage, "judge_rig", judge_rig)
    return judge_rig


def test_stopped_chunk_goes_on_where_it_was_and_leaves_no_checkpoint(judge, judged, tmp_path):
    expected = judge(0, 1, 2)
    judged.numbers, judged.stop = [], 1
    with pytest.raises(KeyboardInterrupt):
        judge(0, 1, 2, name="again.json")
    judged.stop = None
    assert judge(0, 1, 2, name="again.json") == expected
    assert judged.numbers == [0, 1, 2]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["again.json", "rigs.json"]


@pytest.mark.parametrize("change", [{"version": "w"}, {"seed": 7}, {"angle_deg": (1.0, 120.0)}])
def test_checkpoint_of_other_code_or_settings_is_not_used(judge, judged, change):
    judged.stop = 1
    with pytest.raises(KeyboardInterrupt):
        judge(0, 1)
    judged.numbers, judged.stop = [], None
    judge(0, 1, **change)
    assert judged.numbers == [0, 1]


# --- summary --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def real(settings, on_rig, drawing):
    """Two rigs through all of the tables, and in doing so through all of the code."""
    how = settings | {"ensemble": drawing, "free": FREE, "on_rig": on_rig}
    return [{"rig": number} | ensemble.judge_rig({"rig": number}, **how) for number in (0, 1)]


def test_errors_are_those_of_the_full_models_on_the_drawn_rig(real, on_rig, settings):
    for rig in real:
        data = simulate(rig_of(rig, on_rig), rig["seed"])
        how = Judgement(**settings["judgement"], seed=rig["seed"])
        assert rig["compared"] == compare_models(data, how)[0]


def with_fprc_best(rig, number, best):
    """Return a copy of a rig with another number on which C2 holds, or does not."""
    changed = copy.deepcopy(rig) | {"rig": number, "seed": SEED + number, "draws": number + 1}
    changed["parameters"]["bending.preload_kpa"] = 0.1 * number
    changed["parameters"]["bending.stiffness_kpa_per_deg"] = 0.05 * ((7 * number) % 11)
    for report in changed["compared"]["models"]:
        if report["trained_on"] == "sweep":
            report["test_rmse_kpa"] = 15.0 + (report["model"] == "fprc") * (-5.0 if best else 5.0)
    return changed


@pytest.fixture
def summarise(tmp_path):
    def call(*chunks):
        paths = []
        for number, rigs in enumerate(chunks):
            paths.append(str(tmp_path / f"{number}.json"))
            write_json(paths[-1], {"source": "sim", "rigs": rigs})
        summarise_rigs(
            str(PUBLISHED), paths, str(tmp_path / "summary.json"), drawn="rigs", terms=[]
        )
        return read_json(tmp_path / "summary.json")

    return call


@pytest.fixture
def rigs(real):
    """Six rigs, of which one cannot be judged; C2 holds on the three with the least preload."""
    good = [with_fprc_best(real[number % 2], number, number < 3) for number in range(5)]
    bad = {"rig": 5, "seed": SEED + 5, "draws": 6, "parameters": good[0]["parameters"]}
    return [*good, bad | {"failed": "it diverged"}]


def test_summary_counts_rigs_failures_and_draws(summarise, rigs):
    found = summarise(rigs[3:], rigs[:3])
    assert found["source"] == "sim"
    assert found["seeds"] == [SEED + number for number in (3, 4, 5, 0, 1, 2)]
    assert (found["rigs"], found["failed"], found["draws"]) == (6, 1, 1 + 2 + 3 + 4 + 5 + 6)
    assert found["parameters"] == PATHS


def test_summary_counts_on_how_many_rigs_each_claim_holds(summarise, rigs):
    found = {row["id"]: row for row in summarise(rigs[:2], rigs[2:])["claims"]}
    printed = yaml.safe_load(PUBLISHED.read_text(encoding="utf-8"))
    claims = {claim.id: claim for claim in JUDGED_BY_RIG}
    assert list(found) == list(claims)
    assert (found["C2"]["holds"], found["C2"]["rigs"], found["C2"]["share"]) == (3, 5, 0.6)
    for name, row in found.items():
        alone = [
            judge_claims(
                Results([r["compared"]], [], [r["measured"]], {}, {}), printed, (), [claims[name]]
            )
            for r in rigs[:5]
        ]
        assert row["holds"] == sum(rows[0]["verdict"] == "reproduced" for rows in alone)
        assert row["claim"] == claims[name].text


def test_summary_correlates_claims_with_the_parameters_of_their_rigs(summarise, rigs):
    found = {row["id"]: row for row in summarise(rigs)["claims"]}["C2"]["correlations"]
    # three of five ranks below the other two
    assert found["bending.preload_kpa"] == pytest.approx(-np.sqrt(0.75))
    assert list(found) == PATHS or found == {}


def test_summary_gives_the_worth_of_p_o_with_all_rigs_first(summarise, rigs):
    found = summarise(rigs)
    (share,) = [row for row in found["claims"] if row["id"] == "B1"]
    everything, *given = found["worth_given"]
    assert {key: everything[key] for key in ("holds", "rigs", "share", "low", "high")} == {
        key: share[key] for key in ("holds", "rigs", "share", "low", "high")
    }
    assert everything["ratio"][0] == found["worth"][0]
    holds = {row["id"]: row["holds"] for row in found["claims"]}
    alone = {row["given"][0]: row["rigs"] for row in given if len(row["given"]) == 1}
    assert alone == {name: holds[name] for name in ("C8a", "C18a")}


def test_summary_counts_the_rigs_within_a_limit(summarise, real):
    """One of four rigs has the printed errors of Tables II and III."""
    printed = yaml.safe_load(PUBLISHED.read_text(encoding="utf-8"))
    rigs = [copy.deepcopy(real[0]) | {"rig": number, "seed": SEED + number} for number in range(4)]
    for report in rigs[2]["compared"]["models"]:
        table = "table_2_models" if report["trained_on"] == "sweep" else "table_3_reversed"
        own = printed[table][report["model"]]
        report["test_rmse_kpa"] = own["test_rmse_kpa"]
        for phase in ("train_rmse_kpa", "validation_rmse_kpa"):
            report[phase] = [own[phase][0]] * len(report[phase])
    found = {row["limit"]: row for row in summarise(rigs)["near_print"]}
    tables = found["Tables II and III, both limits"]
    assert (tables["holds"], tables["rigs"], tables["share"]) == (1, 4, 0.25)
    assert set(tables["claims"]) == {claim.id for claim in JUDGED_BY_RIG}
    assert tables["claims"]["C2"] == 1
    assert found["all four limits"]["holds"] <= found["Table IV, both limits"]["holds"]


def test_order_of_the_chunks_does_not_matter(summarise, rigs):
    found = [summarise(rigs[:2], rigs[2:]), summarise(rigs[2:], rigs[:2])]
    for one, other in zip(*(report.pop("claims") for report in found), strict=True):
        # sums in another order are rounded otherwise
        assert one.pop("correlations") == pytest.approx(other.pop("correlations"), abs=1e-12)
        assert one == other
    assert sorted(found[0].pop("seeds")) == sorted(found[1].pop("seeds"))
    assert found[0].pop("deviation") == pytest.approx(found[1].pop("deviation"), abs=1e-12)
    assert found[0] == found[1]


def test_ensemble_without_a_single_good_rig_is_an_error(summarise, rigs):
    with pytest.raises(FprcError, match=r"none of the 2 rigs .* the first: it diverged"):
        summarise(rigs[5:], rigs[5:])


# --- sensitivity ----------------------------------------------------------------------------------

SURROGATE = {"stride": 9, "esn_nodes": 6}
MOVED = ["bending.preload_kpa", "drift.sigma_kpa"]


@pytest.fixture
def sensitivity(tmp_path, settings):
    def call(paths=MOVED, steps=3, **changes):
        stage.measure_sensitivity(
            str(tmp_path / "effects.json"),
            on_rig=settings["on_rig"], models=settings["judgement"]["models"],
            **{
                "paths": paths, "steps": steps, "seeds": [3, 4], "surrogate": SURROGATE,
                "workers": 1, "checkpoint": str(tmp_path / "partial.jsonl"), "version": "v",
            } | changes,
        )  # fmt: skip
        return read_json(tmp_path / "effects.json")

    return call


@pytest.fixture
def moved(monkeypatch):
    """Rigs and seeds in the order in which the surrogate judges them."""
    seen = []

    def judge(on_rig, seed, models, surrogate, grids, tracking):
        rig = on_rig.rig
        if rig["bending"]["preload_kpa"] == 77.0:
            raise judge.failure
        seen.append((rig, seed))
        return {"errors": {"sweep/esn/train": float(seed) + rig["drift"]["sigma_kpa"]}}

    judge.failure = DIVERGED
    judge.seen = seen
    monkeypatch.setattr(ensemble, "judge_by_surrogate", judge)
    return judge


def test_unmoved_rig_comes_first_and_then_each_parameter_from_end_to_end(
    sensitivity, moved, on_rig
):
    found = sensitivity()
    assert (found["source"], found["seeds"]) == ("sim", [3, 4])
    assert [(cell["path"], cell["share"]) for cell in found["cells"]] == [
        (None, None), *((path, share) for path in MOVED for share in (0.0, 0.5, 1.0)),
    ]  # fmt: skip
    assert moved.seen[0] == (on_rig.rig, 3)
    assert [seed for _, seed in moved.seen] == [3, 4] * 6
    values = [(r["bending"]["preload_kpa"], r["drift"]["sigma_kpa"]) for r, _ in moved.seen[::2]]
    assert values == [(45.0, 8.0), (20.0, 8.0), (48.5, 8.0), (45.0, 0.0), (45.0, 7.5), (45.0, 15.0)]
    for rig, _ in moved.seen:
        rest = copy.deepcopy(rig)
        rest["bending"]["preload_kpa"], rest["drift"]["sigma_kpa"] = 45.0, 8.0
        assert rest == on_rig.rig


def test_errors_are_the_means_of_the_seeds(sensitivity, moved):
    errors = {(cell["path"], cell["share"]): cell["errors"] for cell in sensitivity()["cells"]}
    assert errors[None, None] == {"sweep/esn/train": 3.5 + 8.0}
    assert errors["drift.sigma_kpa", 0.0] == {"sweep/esn/train": 3.5}
    assert errors["drift.sigma_kpa", 1.0] == {"sweep/esn/train": 3.5 + 15.0}


@pytest.mark.parametrize(
    "failure",
    [
        DIVERGED,
        EvaluationError("a loop cannot be measured"),
        RunAbortedError("run stopped at sample 3: it diverged", {}),
    ],
    ids=lambda failure: type(failure).__name__,
)
def test_rig_that_cannot_be_simulated_is_recorded_as_impossible(sensitivity, moved, failure):
    moved.failure = failure
    cells = {(cell["path"], cell["share"]): cell for cell in sensitivity()["cells"]}
    bad = cells.pop(("bending.preload_kpa", 1.0))
    assert bad["errors"] is None
    assert bad["impossible"] == str(failure)
    assert all(cell["errors"] and "impossible" not in cell for cell in cells.values())


STIFF = "reservoir.slip_distance_ml"


def test_rig_that_breaks_a_rule_is_recorded_as_impossible(sensitivity, moved):
    rig = decode(np.zeros(1), Rig().model_dump(mode="json"), free_parameters([STIFF]))
    with pytest.raises(ValueError, match="squeeze covers"):
        Rig.model_validate(rig)
    _, low, high = sensitivity([STIFF], steps=2)["cells"]
    assert low["errors"] is None
    assert low["impossible"]
    assert high["errors"] is not None


def test_errors_are_those_of_the_surrogate_on_the_moved_rig(sensitivity, settings, on_rig):
    rig = copy.deepcopy(on_rig.rig)
    rig["drift"]["sigma_kpa"] = 15.0
    moved, models = replace(on_rig, rig=rig), settings["judgement"]["models"]
    alone = [
        judge_by_surrogate(moved, seed, models, SURROGATE, {}, {})["errors"] for seed in (3, 4)
    ]
    expected = {key: np.mean([errors[key] for errors in alone]) for key in alone[0]}
    assert sensitivity(["drift.sigma_kpa"], steps=2)["cells"][-1]["errors"] == pytest.approx(
        expected
    )


def test_stopped_measurement_goes_on_where_it_was(sensitivity, moved):
    expected = sensitivity()
    moved.failure = KeyboardInterrupt()
    moved.seen.clear()
    with pytest.raises(KeyboardInterrupt):
        sensitivity()
    assert len(moved.seen) == 2 * 3
    moved.failure = DIVERGED
    assert sensitivity() == expected
    assert len(moved.seen) == 2 * 6
