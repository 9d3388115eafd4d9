"""Verdicts on several pairs at once, against closed forms, brute force and simulation."""

import math
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.stats import ttest_1samp

from fprc.evaluation.paired import ALPHA, Part, decide_together, holm

MARGIN = math.log(1.05)
SAMPLES = st.lists(st.floats(-0.3, 0.3), min_size=4, max_size=12).filter(
    lambda values: np.std(values) > 1e-6
)
LEVELS = st.floats(0.001, 0.3)


def part(values, **more):
    return Part("ours / theirs", dict(enumerate(values)), **more)


def normal(mean, std, units, seed=0):
    """Return a sample whose mean and standard deviation are exactly these."""
    sample = np.random.default_rng(seed).standard_normal(units)
    return mean + std * (sample - sample.mean()) / sample.std(ddof=1)


def outcomes_of(*claims, **how):
    """Return the outcome of each claim, given by its parts."""
    named = {str(number): ("Text.", parts) for number, parts in enumerate(claims)}
    by_claim = {row["id"]: SimpleNamespace(**row) for row in decide_together(named, **how)}
    return list(by_claim.values())


def judge(*samples, **more):
    """Return the outcome of a claim alone."""
    (outcome,) = outcomes_of([part(sample, **more) for sample in samples])
    return outcome


@given(SAMPLES, LEVELS)
def test_equivalence_is_two_one_sided_tests(values, level):
    ps = (
        ttest_1samp(values, MARGIN, alternative="less").pvalue,
        ttest_1samp(values, -MARGIN, alternative="greater").pvalue,
    )
    assert (part(values).verdict(level) == "equivalent") == (max(ps) <= level / 2)


@given(SAMPLES, LEVELS)
def test_superior_and_inferior_are_t_tests(values, level):
    test = ttest_1samp(values, 0.0)
    expected = "undecided"
    if test.pvalue < level:
        expected = "superior" if test.statistic < 0 else "inferior"
    assert part(values, limit=1.1).verdict(level) == expected


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=6))
@example([0.03, 0.03])  # neither, although either alone would be decided
def test_holm_is_the_closure_of_bonferroni(p):
    """A claim is decided if Bonferroni rejects every set of claims that it is in."""
    everything = range(len(p))
    closure = [
        max(
            min(1.0, size * min(p[j] for j in chosen))
            for size in range(1, len(p) + 1)
            for chosen in combinations(everything, size)
            if i in chosen
        )
        for i in everything
    ]
    adjusted, levels = holm(np.array(p))
    assert adjusted == pytest.approx(closure)
    decided = np.array(p) <= levels
    assert (decided == (adjusted <= ALPHA)).all() or np.isclose(adjusted, ALPHA).any()


def test_claim_that_only_a_lower_level_decides_does_not_ease_the_next_one():
    """Its first part is inferior at 0.001, and equivalent at the level of the first claim."""
    loose = [part(normal(math.log(1.03), 0.02, 12)), part(normal(0.0, 1.0, 12))]
    first, second = outcomes_of(loose, [part(normal(-0.3, 0.05, 12))])
    assert (first.verdict, first.p) == ("undecided", 1.0)
    assert (second.verdict, second.level) == ("superior", ALPHA / 2)


MEANS = st.sampled_from([-0.3, -0.04, 0.0, 0.02, 0.03, 0.04, 0.3])
ERRORS = st.sampled_from([0.001, 0.005, 0.01, 0.02, 0.1])


@settings(deadline=None)
@given(st.lists(st.lists(st.tuples(MEANS, ERRORS), min_size=1, max_size=3), min_size=1, max_size=4))
def test_claim_is_decided_if_its_p_is_below_the_level_of_all(numbers):
    """Whatever its parts are: one may be inferior at a low level and equivalent at a higher one."""
    units = 12
    claims = [
        [part(normal(mean, error * math.sqrt(units), units)) for mean, error in of_claim]
        for of_claim in numbers
    ]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("fprc.evaluation.paired._share_of_subsets", lambda *rest: 1.0)
        outcomes = outcomes_of(*claims)
    for outcome in outcomes:
        assert (outcome.verdict != "undecided") == (outcome.p <= ALPHA)


def test_a_claim_that_is_not_judged_still_counts():
    weak = [part(normal(-0.1, 0.125, 12))]  # p = 0.018
    assert outcomes_of(weak)[0].p == pytest.approx(0.0178, abs=5e-4)
    outcomes = outcomes_of(weak, [part([])], [part([-0.1])])
    assert [outcome.verdict for outcome in outcomes] == ["undecided", "not judged", "not judged"]
    assert outcomes[0].p == pytest.approx(3 * 0.0178, abs=2e-3)
    assert outcomes[0].level == pytest.approx(ALPHA / 3)


@pytest.mark.parametrize(
    ("first", "second", "verdict"),
    # of a second one of None nothing is known
    [(-0.3, -0.3, "superior"), (-0.3, 0.0, "equivalent"), (-0.3, 0.3, "inferior"),
     (0.0, 0.3, "inferior"), (0.0, 0.0, "equivalent"), (-0.3, None, "undecided"),
     (0.3, None, "inferior")],
)  # fmt: skip
def test_verdict_of_two_parts_is_the_weaker(first, second, verdict):
    parts = normal(first, 0.01, 12), normal(second or 0.0, 1.0 if second is None else 0.01, 12)
    assert judge(*parts).verdict == judge(*reversed(parts)).verdict == verdict


def test_p_of_two_parts_is_that_of_the_weaker():
    weak, strong = normal(-0.1, 0.125, 12), normal(-0.3, 0.01, 12)
    assert judge(strong, weak).p == pytest.approx(2 * judge(weak).p)
    assert judge(strong, weak).level == pytest.approx(judge(weak).level / 2)
    # one part that is inferior decides the claim
    assert judge(normal(0.3, 0.01, 12), weak).p < judge(weak).p


def test_interval_of_blocks_has_the_variance_of_nadeau_and_bengio():
    values, blocks, overlap = normal(-0.1, 0.05, 10), 10, 100 / 860
    error = math.sqrt((1 / blocks + overlap) * 0.05**2)
    half = 2.2622 * error  # quantile of t with 9 degrees of freedom
    found = part(values, overlap=overlap).interval(0.05)
    assert found == pytest.approx((-0.1, -0.1 - half, -0.1 + half), abs=1e-5)


@given(SAMPLES, LEVELS, st.sampled_from([0.0, 0.1]))
def test_verdict_is_what_the_interval_says_that_is_shown(values, level, overlap):
    found = part(values, overlap=overlap, limit=1.1)
    _, low, high = found.interval(level)
    expected = "superior" if high < 0.0 else "inferior" if low > 0.0 else "undecided"
    assert found.verdict(level) == expected


def test_verdict_that_fewer_units_turn_is_undecided():
    values = normal(-0.1, 0.13, 12)  # p = 0.02
    outcome = judge(values)
    assert part(values).verdict(ALPHA) == "superior"
    shares = [
        part(subset).verdict(ALPHA) == "superior"
        for subset in combinations(values, len(values) - 5)
    ]
    assert outcome.verdict == "undecided"
    assert outcome.stable == pytest.approx(np.mean(shares), abs=0.12)
    assert outcome.stable < 0.95


@pytest.mark.parametrize(
    ("values", "verdict", "stable"),
    [
        (normal(-0.1, 0.02, 12), "superior", 1.0),
        ([*normal(-0.1, 0.02, 12)[1:], 1.0], "undecided", None),  # one outlier
        (normal(-0.5, 0.01, 7), "undecided", None),  # too few
        (normal(-0.5, 0.01, 8), "superior", 1.0),
        ([-0.2] * 10, "superior", 1.0),  # all units agree
        ([0.0] * 10, "equivalent", 1.0),
    ],
)
def test_verdict_of_a_claim_alone(values, verdict, stable):
    outcome = judge(values)
    assert (outcome.verdict, outcome.stable) == (verdict, stable)
