import importlib
import math
from types import SimpleNamespace

import numpy as np
import pytest

from fprc.studies.calibration.search import search

POPULATION, GENERATIONS = 8, 6
TARGET = np.array([0.02, 0.5, 0.97])


def numbers_of(point):
    """Nonlinear functions of a point, as the measures of a rig are."""
    return [math.exp(2.0 * point[0]), math.tanh(2.0 * point[1]) + point[0], point[2] ** 2]


def distances(numbers, target=TARGET):
    """Deviations of numbers from those of the target: zero at the target only."""
    return np.array(numbers) - np.array(numbers_of(target))


@pytest.fixture
def run(tmp_path):
    """Search in the cube and return what was found; the points that were judged are ``points``."""

    def call(*, stops_at=None, name="search.jsonl", judge=numbers_of, **options):
        call.points = []

        def judge_point(point):
            if len(call.points) == stops_at:
                raise KeyboardInterrupt
            call.points.append(tuple(point.tolist()))
            return judge(point)

        call.checkpoint = tmp_path / name
        settings = {
            "deviations_of": distances,
            "start": np.full(3, 0.4),
            "step": 0.1,
            "generations": GENERATIONS,
            "seed": 3,
            "workers": 1,
            "key": "k",
        }
        return search(judge_point, checkpoint=call.checkpoint, **settings | options)

    return call


@pytest.fixture
def undisturbed(run):
    """Return what a search that nothing stops finds, its points, and its checkpoint."""

    def go(**options):
        found = run(name="undisturbed.jsonl", **options)
        return found, run.points, run.checkpoint.read_text(encoding="utf-8")

    return go


def same(one, other):
    np.testing.assert_array_equal(one.point, other.point)
    np.testing.assert_array_equal(one.numbers, other.numbers)
    bare = {"point": None, "numbers": None}
    return one._replace(**bare) == other._replace(**bare)


def lines(run):
    return run.checkpoint.read_text(encoding="utf-8").splitlines()


# --- what is found --------------------------------------------------------------------------------


def rosenbrock(point):
    """Numbers of which the squares sum to Rosenbrock's function of -2 to 2; least at 0.75."""
    x = 4.0 * np.asarray(point) - 2.0
    return [*(10.0 * (x[1:] - x[:-1] ** 2)), *(1.0 - x[:-1])]


def rates(point):
    """Values of ten exponentials that the coordinates mix, as far from linear as errors are."""
    mixed = np.cos(np.outer(np.arange(1, 11), np.arange(1, 11))) / 3.0
    return np.exp(mixed @ (np.asarray(point) - 0.5)).tolist()


PROBLEMS = {
    "rosenbrock": (rosenbrock, np.asarray, np.array([0.4, 0.6])),
    "exponentials": (
        rates,
        lambda numbers: (np.array(numbers) - rates(np.linspace(0.1, 0.9, 10))) / 0.05,
        np.full(10, 0.5),
    ),
}


@pytest.mark.parametrize("name", PROBLEMS)
def test_minimum_of_what_is_far_from_linear_is_found(run, name):
    judge, deviations_of, start = PROBLEMS[name]
    found = run(judge=judge, deviations_of=deviations_of, start=start, generations=30)

    def loss(point):
        return float(np.sum(deviations_of(judge(point)) ** 2))

    assert found.loss == pytest.approx(loss(found.point), rel=1e-12)
    assert found.loss < 1e-4 * loss(start)


def test_minimum_outside_the_cube_is_found_on_its_face_and_no_point_leaves_it(run):
    outside = np.array([-0.5, 0.3, 1.4])
    found = run(
        judge=lambda point: point.tolist(),
        deviations_of=lambda numbers: np.array(numbers) - outside,
        generations=25,
        step=0.5,
    )
    assert found.point == pytest.approx([0.0, 0.3, 1.0], abs=5e-3)
    assert np.min(run.points) >= 0.0
    assert np.max(run.points) <= 1.0


def test_best_of_all_points_that_were_judged_is_found(run):
    found = run()
    losses = [float(np.sum(distances(numbers_of(point)) ** 2)) for point in run.points]
    assert found.loss == min(losses)
    assert tuple(found.point) == run.points[int(np.argmin(losses))]
    assert (found.generations, found.evaluations) == (GENERATIONS, len(run.points))
    assert len(run.points) == GENERATIONS * POPULATION


@pytest.mark.slow
def test_two_processes_find_what_one_finds(tmp_path):
    def judge(point):  # not at module level, since the processes cannot import this module
        return [math.exp(2.0 * point[0]), point[1] ** 2]

    found = [
        search(
            judge, np.array, np.full(2, 0.4), step=0.1, generations=3, seed=1,
            workers=workers, checkpoint=tmp_path / f"{workers}.jsonl", key="k",
        )
        for workers in (1, 2)
    ]  # fmt: skip
    assert same(*found)
    assert (tmp_path / "1.jsonl").read_bytes() == (tmp_path / "2.jsonl").read_bytes()


# --- impossible points ----------------------------------------------------------------------------


def unless(impossible):
    return lambda point: None if impossible(point) else numbers_of(point)


def test_impossible_points_are_passed_over(run):
    found = run(judge=unless(lambda point: point[1] > 0.45), generations=25)
    assert found.point[1] <= 0.45
    # of what is possible, the nearest to the target
    assert found.loss < 1.2 * float(np.sum(distances(numbers_of([0.02, 0.45, 0.97])) ** 2))
    assert found.evaluations == 25 * POPULATION


def test_search_goes_on_until_a_point_is_possible(run):
    """No point of the first three generations is."""
    tried = []

    def judge(point):
        tried.append(point)
        return None if len(tried) <= 3 * POPULATION else numbers_of(point)

    heard = []
    found = run(judge=judge, generations=25, progress=lambda *told: heard.append(told[2]))
    assert heard[:3] == [math.inf] * 3
    assert found.point == pytest.approx(TARGET, abs=5e-3)


# --- interrupted, and called again ----------------------------------------------------------------


@pytest.mark.parametrize("stops_at", [0, 1, *range(7, GENERATIONS * POPULATION, 8)])
def test_interrupted_search_goes_on_as_if_nothing_had_been(run, undisturbed, stops_at):
    expected, points, kept = undisturbed()
    with pytest.raises(KeyboardInterrupt):
        run(stops_at=stops_at)
    finished = stops_at // POPULATION
    assert run.points[: finished * POPULATION] == points[: finished * POPULATION]
    assert len(lines(run)) == 1 + finished
    assert same(run(), expected)
    assert run.points == points[finished * POPULATION :]
    assert run.checkpoint.read_text(encoding="utf-8") == kept


def test_more_generations_go_on_from_those_that_are_finished(run, undisturbed):
    expected, points, _ = undisturbed(generations=GENERATIONS + 2)
    assert run().finished
    assert same(run(generations=GENERATIONS + 2), expected)
    assert run.points == points[GENERATIONS * POPULATION :]


@pytest.mark.parametrize(
    "change",
    [{"key": "l"}, {"seed": 4}, {"step": 0.3}, {"start": np.array([0.4, 0.4, 0.5])}],
    ids=lambda change: next(iter(change)),
)
def test_search_for_something_else_begins_anew(run, undisturbed, change):
    expected, points, kept = undisturbed(**change)
    run()
    assert same(run(**change), expected)
    assert run.points == points
    assert run.checkpoint.read_text(encoding="utf-8") == kept


# --- time limit -----------------------------------------------------------------------------------


@pytest.fixture
def clock(monkeypatch, run):
    """A clock on which judging one point takes a second."""
    watch = SimpleNamespace(monotonic=lambda: float(len(run.points)))
    monkeypatch.setattr(importlib.import_module("fprc.studies.calibration.search"), "time", watch)


@pytest.mark.parametrize(("seconds", "generations"), [(0.0, 1), (8.0, 1), (8.5, 2), (24.5, 4)])
@pytest.mark.usefixtures("clock")
def test_no_generation_but_the_first_begins_after_the_time_limit(
    run, undisturbed, seconds, generations
):
    found = run(seconds=seconds)
    assert not found.finished
    assert math.isfinite(found.loss)
    assert (found.generations, found.evaluations) == (generations, generations * POPULATION)
    assert len(run.points) == found.evaluations
    expected, points, kept = undisturbed()
    assert same(run(), expected)
    assert run.points == points[generations * POPULATION :]
    assert run.checkpoint.read_text(encoding="utf-8") == kept


def test_search_in_which_nothing_is_possible_gives_its_start(run):
    found = run(judge=lambda point: None)
    assert found.point.tolist() == [0.4, 0.4, 0.4]
    assert (found.loss, found.generations, found.finished) == (math.inf, GENERATIONS, True)
