import numpy as np
import pytest

from fprc.studies.calibration.search import search_round

MIX = np.cos(np.outer(np.arange(1, 11), np.arange(1, 11))) / 3.0
BEST = np.linspace(0.1, 0.9, 10)


def rates(point):
    """Values of ten exponentials that the coordinates mix, as far from linear as errors are."""
    return np.exp(MIX @ (np.asarray(point) - 0.5))


def rosenbrock(point):
    """Numbers of which the squares sum to Rosenbrock's function of -2 to 2; least at 0.75."""
    x = 4.0 * np.asarray(point) - 2.0
    return np.array([*(10.0 * (x[1:] - x[:-1] ** 2)), *(1.0 - x[:-1])])


def find(number_of, misses_of, start, rounds, *, possible=lambda point: True):
    """Search for some rounds; ``find.judged`` are all points."""
    find.judged = []

    def judge(points):
        find.judged += list(points)
        return [number_of(point) if possible(point) else None for point in points]

    point = np.asarray(start, dtype=float)
    for _ in range(rounds):
        loss, point = search_round(judge, misses_of, point)
    return loss, point


def misses_of_rates(numbers):
    return (numbers - rates(BEST)) / 0.05


@pytest.mark.parametrize(
    ("number_of", "misses_of", "start", "best", "rounds"),
    [
        (rates, misses_of_rates, np.full(10, 0.5), BEST, 4),
        (rosenbrock, np.asarray, [0.4, 0.6], [0.75, 0.75], 6),
    ],
)
def test_rounds_end_at_the_best_point(number_of, misses_of, start, best, rounds):
    loss, point = find(number_of, misses_of, start, rounds)
    assert point == pytest.approx(best, abs=0.02)
    assert loss == pytest.approx(np.sum(misses_of(number_of(point)) ** 2))
    assert all((p >= 0.0).all() and (p <= 1.0).all() for p in find.judged)


def test_impossible_points_are_passed_by_and_the_bound_is_reached():
    best = np.array([1.2, 0.5, 0.3])
    _, point = find(
        np.copy, lambda numbers: (numbers - best) / 0.02, np.full(3, 0.6), 3,
        possible=lambda point: not 0.2 < point[2] < 0.35,
    )  # fmt: skip
    assert point[:2] == pytest.approx([1.0, 0.5], abs=0.1)
    assert not 0.2 < point[2] < 0.35


def test_round_from_an_impossible_point_ends_there():
    loss, point = find(np.copy, np.copy, [0.5, 0.5], 1, possible=lambda point: False)
    assert (loss, point.tolist()) == (np.inf, [0.5, 0.5])
