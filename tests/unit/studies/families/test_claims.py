import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import hypergeom, norm, spearmanr, t

from fprc.claims.paper import CLAIMS
from fprc.studies.families.claims import CONDITIONS, JUDGED_BY_RIG, shares_of, worth_given

CLAIM = {claim.id: claim for claim in CLAIMS}["C2"]._replace(text="FPRC is best")
VERDICTS = {True: "reproduced", False: "not reproduced"}


def shares(held, values, **options):
    """Return the row of one claim that holds on some rigs, whose parameters are the columns."""
    verdicts = [{"C2": VERDICTS[bool(holds)], "C1": "reproduced"} for holds in held]
    parameters = [{f"p{k}": float(value) for k, value in enumerate(rig)} for rig in values]
    (row,) = shares_of([CLAIM], verdicts, parameters, **options)
    return row


def spread(rigs, parameters=1):
    """Return parameters that differ from rig to rig."""
    return np.random.default_rng(1).uniform(size=(rigs, parameters))


def wilson(holds, rigs, level):
    """Return where |p - share| is what chance allows at p (Wilson 1927)."""
    z = norm.isf(0.5 * (1.0 - level))
    share = holds / rigs
    middle = (share + z * z / (2 * rigs)) / (1 + z * z / rigs)
    arm = z / (1 + z * z / rigs) * math.sqrt(share * (1 - share) / rigs + (z / (2 * rigs)) ** 2)
    return middle - arm, middle + arm


# --- shares ---------------------------------------------------------------------------------------


@given(st.integers(1, 200), st.floats(0.0, 1.0), st.sampled_from([0.5, 0.9, 0.95, 0.99]))
def test_interval_is_wilsons(rigs, share, level):
    holds = round(share * rigs)
    row = shares(np.arange(rigs) < holds, spread(rigs), level=level)
    assert (row["low"], row["high"]) == pytest.approx(wilson(holds, rigs, level), abs=1e-12)
    assert (row["holds"], row["rigs"], row["share"]) == (holds, rigs, holds / rigs)
    assert 0.0 <= row["low"] <= row["share"] <= row["high"] <= 1.0


def test_interval_of_forty_rigs_that_agree_is_that_of_the_textbook():
    # z^2 / (n + z^2)
    row = shares([False] * 40, spread(40))
    assert (row["low"], row["high"]) == pytest.approx((0.0, 0.0876), abs=5e-5)


def test_claim_that_is_undecided_does_not_hold():
    verdicts = [{"C2": verdict} for verdict in ("reproduced", "undecided")]
    (row,) = shares_of([CLAIM], verdicts, [{"p": 0.0}, {"p": 1.0}])
    assert (row["holds"], row["rigs"]) == (1, 2)


def test_rows_are_those_of_the_claims_in_their_order():
    claims = [CLAIM._replace(id=name, text=f"text of {name}") for name in ("C7", "C2")]
    verdicts = [
        {"C1": "reproduced", "C2": "reproduced", "C7": "not reproduced"},
        {"C1": "reproduced", "C2": "reproduced", "C7": "reproduced"},
    ]
    rows = shares_of(claims, verdicts, [{"p": 0.0}, {"p": 1.0}])
    assert [(row["id"], row["claim"], row["holds"]) for row in rows] == [
        ("C7", "text of C7", 1), ("C2", "text of C2", 2),
    ]  # fmt: skip


def test_numbers_can_be_written_as_json():
    row = shares([True, False, True, True, False], spread(5, 2))
    assert {key: type(value) for key, value in row.items()} == {
        "id": str, "claim": str, "holds": int, "rigs": int, "share": float, "low": float,
        "high": float, "correlations": dict, "least_significant": float,
    }  # fmt: skip
    assert {type(value) for value in row["correlations"].values()} == {float}


def test_claims_that_a_rig_decides_need_no_grids_and_no_times():
    # the rig has hardly a way from the reservoir's bending to P_o: C17 is assumed
    assert {claim.id for claim in JUDGED_BY_RIG} == {"B1"} | {
        claim.id
        for claim in CLAIMS
        if claim.id.rstrip("abcd") not in {"C5", "C6", "C9", "C10", "C11", "C12", "C17"}
    }


# --- correlations ---------------------------------------------------------------------------------


@given(st.integers(5, 60), st.integers(1, 4), st.randoms(use_true_random=False))
def test_correlations_are_spearmans(rigs, parameters, random):
    held = [True, False, *(random.random() < 0.5 for _ in range(rigs - 2))]
    # few values, so that some are tied
    values = [[random.randrange(9) for _ in range(parameters)] for _ in range(rigs)]
    values[0], values[1] = [-1] * parameters, [9] * parameters
    row = shares(held, values)
    assert list(row["correlations"]) == [f"p{k}" for k in range(parameters)]
    for found, column in zip(row["correlations"].values(), zip(*values, strict=True), strict=True):
        assert found == pytest.approx(spearmanr(held, column).statistic, abs=1e-12)


def test_correlation_is_positive_where_the_claim_holds_at_large_values():
    held = np.arange(20) >= 10
    row = shares(held, np.column_stack([np.arange(20), -np.arange(20), np.exp(np.arange(20))]))
    rising, falling, warped = row["correlations"].values()
    assert rising == pytest.approx(math.sqrt(0.75 * 400 / 399))
    assert falling == pytest.approx(-rising)
    assert warped == pytest.approx(rising)


@pytest.mark.parametrize("holds", [True, False])
def test_rigs_that_agree_have_no_correlations(holds):
    assert shares([holds] * 12, spread(12, 3))["correlations"] == {}


# --- what chance alone gives ----------------------------------------------------------------------


@pytest.mark.parametrize("rigs", [1, 2, 3])
def test_no_correlation_of_three_rigs_is_beyond_chance(rigs):
    held = np.arange(rigs) % 2 == 0
    assert shares(held, spread(rigs, 2))["least_significant"] == 1.0


def test_no_correlation_is_beyond_chance_where_there_is_none():
    assert shares([True] * 12, spread(12, 3))["least_significant"] == 1.0


@given(st.integers(4, 300), st.integers(1, 30), st.integers(1, 12), st.sampled_from([0.9, 0.95]))
def test_limit_is_students_corrected_for_all_correlations_of_the_ensemble(
    rigs, parameters, claims, level
):
    names = [CLAIM._replace(id=f"C{k}") for k in range(claims + 1)]
    # the last claim holds on all rigs, and so has no correlations that chance could exceed
    verdicts = [
        {f"C{k}": VERDICTS[bool(rig % 2) or k == claims] for k in range(claims + 1)}
        for rig in range(rigs)
    ]
    values = [{f"p{k}": v for k, v in enumerate(rig)} for rig in spread(rigs, parameters)]
    (limit,) = {row["least_significant"] for row in shares_of(names, verdicts, values, level)}
    statistic = limit * math.sqrt((rigs - 2) / (1.0 - limit**2))
    assert 2.0 * t.sf(statistic, rigs - 2) * parameters * claims == pytest.approx(
        1.0 - level, rel=1e-6
    )


@pytest.mark.parametrize("share", [0.3, 0.5])
def test_chance_alone_exceeds_the_limit_in_about_one_of_twenty_ensembles(share):
    """Forty rigs of 26 parameters and 11 claims, that have nothing to do with each other."""
    rng = np.random.default_rng(1)
    ensembles, rigs = 1000, 40
    held = rng.uniform(size=(ensembles, 11, rigs)) < share
    values = rng.uniform(size=(ensembles, 26, rigs))
    found = np.matmul(scaled(held), scaled(values.argsort(axis=2).argsort(axis=2)).swapaxes(1, 2))

    names = [CLAIM._replace(id=f"C{k}") for k in range(11)]
    verdicts = [{f"C{k}": VERDICTS[bool(h)] for k, h in enumerate(rig)} for rig in held[0].T]
    parameters = [{f"p{k}": v for k, v in enumerate(rig)} for rig in values[0].T]
    rows = shares_of(names, verdicts, parameters)
    for row, expected in zip(rows, found[0], strict=True):
        assert list(row["correlations"].values()) == pytest.approx(expected, abs=1e-12)

    alarms = np.abs(found).max(axis=(1, 2)) > rows[0]["least_significant"]
    assert 0.02 < alarms.mean() < 0.12


def scaled(rows):
    """Return rows of mean 0 and of length 1."""
    away = rows - rows.mean(axis=2, keepdims=True)
    return away / np.linalg.norm(away, axis=2, keepdims=True)


# --- worth of P_o, given other claims -------------------------------------------------------------


def rig_with(*held):
    return {name: VERDICTS[name in held] for name in ("B1", "C8a", "C18a")}


def row_given(rows, *names):
    (row,) = [row for row in rows if row["given"] == list(names)]
    return row


def test_worth_is_counted_on_the_rigs_on_which_the_other_claims_hold():
    rigs = [
        rig_with("B1", "C8a"), rig_with("B1", "C8a", "C18a"), rig_with("C8a"), rig_with("C18a"),
        rig_with("B1"), rig_with(), rig_with(),
    ]  # fmt: skip
    rows = worth_given(rigs, [0.5, 0.6, 1.5, 1.2, 0.9, 1.1, 1.3])
    assert [tuple(row["given"]) for row in rows] == list(CONDITIONS)
    assert [(row["holds"], row["rigs"]) for row in rows] == [(3, 7), (2, 3), (1, 2), (1, 1)]
    assert [row["ratio"][0] for row in rows] == [1.1, 0.6, pytest.approx(0.9), 0.6]
    row = row_given(rows, "C8a")
    assert (row["low"], row["high"]) == pytest.approx(wilson(2, 3, 0.95))
    assert row["ratio"] == [0.6, 0.5, 1.5]


def test_condition_that_no_rig_meets_keeps_its_row_and_its_share_of_the_risk():
    rigs = [rig_with("B1", "C8a")] * 4 + [rig_with()] * 4  # p = 2 / 70, between 0.05 / 3 and 0.05
    rows = worth_given(rigs, [0.5] * 4 + [1.5] * 4)
    row = row_given(rows, "C8a")
    assert (row["p"], row["matters"]) == (pytest.approx(2 / 70), False)
    for row in (row_given(rows, "C18a"), row_given(rows, "C8a", "C18a")):
        assert (row["holds"], row["rigs"], row["ratio"]) == (0, 0, [None] * 3)
        assert {row[key] for key in ("share", "low", "high", "p", "matters")} == {None}


def test_condition_matters_if_p_is_below_the_limit():
    rigs = [rig_with("B1", "C8a")] * 5 + [rig_with()] * 5  # p = 2 / 252
    row = row_given(worth_given(rigs, [1.0] * 10), "C8a")
    assert (row["p"], row["matters"]) == (pytest.approx(2 / 252), True)


@given(st.lists(st.tuples(st.booleans(), st.booleans()), min_size=1, max_size=60))
def test_p_is_the_chance_of_a_table_at_least_as_unlikely(rigs):
    verdicts = [rig_with(*(["B1"] * worth), *(["C8a"] * equal)) for worth, equal in rigs]
    rows = worth_given(verdicts, [1.0] * len(rigs))
    p = row_given(rows, "C8a")["p"]
    meets = sum(equal for _, equal in rigs)
    if meets in (0, len(rigs)):
        assert p is None
    else:
        holds = sum(worth for worth, _ in rigs)
        possible = hypergeom(len(rigs), holds, meets).pmf(np.arange(meets + 1))
        seen = sum(worth and equal for worth, equal in rigs)
        expected = possible[possible <= possible[seen] * (1 + 1e-7)].sum()
        assert p == pytest.approx(min(expected, 1.0), rel=1e-6)
    assert row_given(rows)["p"] is None
