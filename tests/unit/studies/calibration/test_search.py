import importlib
import math

import numpy as np
import pytest

from fprc.studies.calibration.search import search

SEARCH = importlib.import_module("fprc.studies.calibration.search")

#: Batches of points, in three dimensions, of a search from two starts: the starts, and in the round
#: of each the neighbours and six steps of three, and where these end.
ROUNDS, BATCHES = 1, (2, *(3, 3, 3, 3, 3, 3, 3) * 2, 2)
TARGET = np.array([0.02, 0.5, 0.97])


def numbers_of(point):
    """Nonlinear functions of a point, as the measures of a rig are."""
    return [math.exp(2.0 * point[0]), math.tanh(2.0 * point[1]) + point[0], point[2] ** 2]


def distances(numbers, target=TARGET):
    """Deviations of numbers from those of the target: zero at the target only."""
    return np.array(numbers) - np.array(numbers_of(target))


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Search in the cube and return what was found; the points that were judged are ``points``."""

    def call(*, stops_at=None, name="search.jsonl", judge=numbers_of, **options):
        call.points = []

        def judge_point(point, beside):
            if len(call.points) == stops_at:
                raise KeyboardInterrupt
            call.points.append(tuple(point.tolist()))
            return judge(point)

        def correct(points):
            found = [judge_point(point, point) for point in points]
            return [numbers and [numbers, [0.0] * len(numbers)] for numbers in found]

        call.checkpoint = tmp_path / name
        settings = {
            "correct": correct,
            "deviations_of": distances,
            "starts": np.array([[0.4, 0.4, 0.4], [0.3, 0.6, 0.5]]),
            "rounds": ROUNDS,
            "workers": 1,
            "key": "k",
        }
        return search(judge_point, checkpoint=call.checkpoint, **settings | options)

    monkeypatch.setattr(SEARCH, "_FAILED", 7)  # so that every round takes as many
    call.folder = tmp_path
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
    np.testing.assert_array_equal(one.ends, other.ends)
    return one._replace(point=None, ends=None) == other._replace(point=None, ends=None)


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
    found = run(judge=judge, deviations_of=deviations_of, starts=start[None], rounds=6)

    def loss(point):
        return float(np.sum(deviations_of(judge(point)) ** 2))

    assert found.loss == pytest.approx(loss(found.point), rel=1e-12)
    assert found.loss < 1e-4 * loss(start)


@pytest.mark.parametrize(("starts", "least"), [([0.1], 0.3), ([0.1, 0.9], 0.0), ([0.9, 0.1], 0.0)])
def test_lowest_of_the_valleys_below_the_starts_is_found(run, starts, least):
    """Two valleys, at 0.2 and at 0.8, that steps of a search do not cross."""
    found = run(
        judge=lambda point: [math.tanh(20.0 * (abs(point[0] - 0.5) - 0.3)), point[0] - 0.8],
        deviations_of=lambda numbers: np.array([numbers[0], math.sqrt(0.3) * (numbers[1] < -0.3)]),
        starts=np.array(starts)[:, None],
    )
    assert found.loss == pytest.approx(least, abs=1e-6)
    assert found.point == pytest.approx([0.2 if least else 0.8], abs=1e-3)
    ends = [0.2] if least else [0.8, 0.2]
    assert np.ravel(found.ends) == pytest.approx(ends, abs=1e-3)


def test_each_round_leaves_the_worse_half_of_the_starts_and_two_that_gain_nothing_end_it(
    run, monkeypatch
):
    """Five plateaus: no step improves any start, so each round is seen in one neighbour."""
    monkeypatch.setattr(SEARCH, "_FAILED", 2)
    levels, starts = [3.0, 1.0, 5.0, 2.0, 4.0], np.linspace(0.1, 0.9, 5)[:, None]
    found = run(
        judge=lambda point: point.tolist(),
        deviations_of=lambda numbers: np.array([levels[int(numbers[0] * 5.0)]]),
        starts=starts,
        rounds=9,
    )
    # the first step is 0.03; the next ones may change by 0.06
    steps = np.array([point[0] - starts[:, 0] for point in run.points])
    neighbours = (np.isclose(steps, 0.03) | np.isclose(steps, 0.06)).sum(axis=0).tolist()
    assert neighbours == [2, 4, 1, 3, 1]
    assert (found.loss, found.rounds) == (1.0, 5 + 3 + 2 + 1)
    assert found.evaluations == (5 + 5 + 3 + 2 + 1) + 11 * (1 + 2 * 3)


def test_minimum_outside_the_cube_is_found_on_its_face_and_no_point_leaves_it(run):
    outside = np.array([-0.5, 0.3, 1.4])
    found = run(
        judge=lambda point: point.tolist(),
        deviations_of=lambda numbers: np.array(numbers) - outside,
        rounds=6,
    )
    assert found.point == pytest.approx([0.0, 0.3, 1.0], abs=5e-3)
    assert np.min(run.points) >= 0.0
    assert np.max(run.points) <= 1.0


def test_best_of_all_points_that_were_judged_is_found(run):
    found = run()
    losses = [float(np.sum(distances(numbers_of(point)) ** 2)) for point in run.points]
    assert found.loss == min(losses)
    assert tuple(found.point) == run.points[int(np.argmin(losses))]
    assert (found.rounds, found.evaluations) == (2 * ROUNDS, len(run.points))
    assert len(run.points) == sum(BATCHES)


@pytest.mark.slow
def test_two_processes_find_what_one_finds(tmp_path):
    def judge(point, beside):  # not at module level, since the processes cannot import this module
        return [math.exp(2.0 * point[0]), point[1] ** 2]

    found = [
        search(
            judge, lambda points: [[judge(*points, None), [0.0, 0.0]]], np.array,
            np.full((1, 2), 0.4), rounds=1, workers=workers, key="k",
            checkpoint=tmp_path / f"{workers}.jsonl",
        )
        for workers in (1, 2)
    ]  # fmt: skip
    assert same(*found)
    assert (tmp_path / "1.jsonl").read_bytes() == (tmp_path / "2.jsonl").read_bytes()


# --- corrections ----------------------------------------------------------------------------------


def test_cheap_numbers_are_corrected_where_each_round_begins(run):
    """What judges is 0.2 too low in each number, and more for a large parameter."""
    asked, begun = [], set()

    def exact(point):
        return [number + 0.2 + 0.3 * x for number, x in zip(numbers_of(point), point, strict=True)]

    def correct(points):
        asked.append([tuple(point.tolist()) for point in points])
        return [
            [numbers_of(point), np.subtract(exact(point), numbers_of(point)).tolist()]
            for point in points
        ]

    def judge(point, beside):
        begun.add(tuple(beside.tolist()))
        return numbers_of(point)

    found = search(
        judge, correct, lambda numbers: np.array(numbers) - exact(TARGET),
        np.array([[0.4, 0.4, 0.4], [0.3, 0.6, 0.5]]), rounds=12, workers=1, key="k",
        checkpoint=run.folder / "search.jsonl",
    )  # fmt: skip
    assert found.point == pytest.approx(TARGET, abs=2e-3)
    assert asked[0] == [(0.4, 0.4, 0.4), (0.3, 0.6, 0.5)]
    assert [len(points) for points in asked[:3]] == [2, 2, 1]
    assert begun <= {point for points in asked for point in points}


@pytest.mark.parametrize(("impossible", "rounds"), [({0}, ROUNDS), ({0, 1}, 0)])
def test_start_that_cannot_be_corrected_is_left(run, impossible, rounds):
    def correct(points):
        found = [[numbers_of(point), [0.0] * 3] for point in points]
        return [None if k in impossible else pair for k, pair in enumerate(found)]

    found = run(correct=correct)
    assert found.rounds == rounds
    assert math.isfinite(found.loss) == bool(rounds)


# --- impossible points ----------------------------------------------------------------------------


def unless(impossible):
    return lambda point: None if impossible(point) else numbers_of(point)


def test_impossible_points_are_passed_over(run):
    found = run(judge=unless(lambda point: point[1] > 0.45), rounds=6)
    assert found.point[1] <= 0.45
    # of what is possible, the nearest to the target
    assert found.loss < 1.2 * float(np.sum(distances(numbers_of([0.02, 0.45, 0.97])) ** 2))
    assert found.evaluations == len(run.points)


def test_search_from_what_is_impossible_gives_its_start(run):
    found = run(judge=lambda point: None)
    assert found.point.tolist() == [0.4, 0.4, 0.4]
    assert (found.loss, found.rounds, found.evaluations) == (math.inf, 0, 2)


def test_impossible_start_is_passed_over(run):
    found = run(judge=unless(lambda point: point.tolist() == [0.4, 0.4, 0.4]))
    assert found.rounds == ROUNDS
    assert run.points[:2] == [(0.4, 0.4, 0.4), (0.3, 0.6, 0.5)]
    assert math.isfinite(found.loss)


# --- interrupted, and called again ----------------------------------------------------------------

ENDS = np.cumsum(BATCHES).tolist()


@pytest.mark.slow
@pytest.mark.parametrize("stops_at", [0, 1, *(end + 1 for end in ENDS[:-1])])
def test_interrupted_search_goes_on_as_if_nothing_had_been(run, undisturbed, stops_at):
    expected, points, kept = undisturbed()
    with pytest.raises(KeyboardInterrupt):
        run(stops_at=stops_at)
    finished = max((end for end in ENDS if end <= stops_at), default=0)
    assert run.points[:finished] == points[:finished]
    assert len(lines(run)) == 1 + sum(end <= stops_at for end in ENDS)
    assert same(run(), expected)
    assert run.points == points[finished:]
    assert run.checkpoint.read_text(encoding="utf-8") == kept


@pytest.mark.parametrize(
    "change", [{"key": "l"}, {"starts": np.array([[0.4, 0.4, 0.5]])}, {"rounds": 2}]
)
def test_search_for_something_else_begins_anew(run, undisturbed, change):
    expected, points, kept = undisturbed(**change)
    run()
    assert same(run(**change), expected)
    assert run.points == points
    assert run.checkpoint.read_text(encoding="utf-8") == kept
