import re

import numpy as np
import pandas as pd
import pytest

from fprc.tables.found import found


def ledger(**verdicts):
    """Rows of a ledger: of each ``rig``, its verdicts."""
    return [
        {"rig": rig.replace("_", " "), "verdict": verdict}
        for rig, several in verdicts.items()
        for verdict in several
    ]


GOOD, BAD, OPEN = "reproduced", "not reproduced", "undecided"
TABLE_2 = pd.DataFrame(
    {
        "model": ["fprc", "fprc", "mine"],
        "metric": ["train_rmse", "test_rmse", "test_rmse"],
        "unit": "kPa",
        "mean": [9.0, 11.26, 99.0],
        "published_mean": [8.0, 11.0, np.nan],
    }
)
TABLE_4 = pd.DataFrame(
    {
        "controller": ["fprc"] * 3 + ["pd"] * 3,
        "reference": ["sine_0p2", "sweep", "disturbance"] * 2,
        "rmse_deg": [2.39, 2.7, 99.0, 9.0, 8.0, 99.0],
        "published_rmse_deg": [2.04, 2.67] + [np.nan] * 4,
    }
)


@pytest.mark.parametrize(
    ("claims", "tables", "simulated", "numbers"),
    [
        ([], {}, True, []),
        # of the claims that the rig was not fitted to, of the others, and of those on times
        (
            ledger(
                predicted=[GOOD, BAD, OPEN],
                fitted=[GOOD, "not informative"],
                half_fitted=[BAD],
                timed=[BAD],
            ),
            {},
            True,
            ["1 3 1 1 1 2 1 0 1 1"],
        ),
        (ledger(predicted=[GOOD, GOOD], assumed=[GOOD], timed=[GOOD]), {}, False, ["3 3 1 1"]),
        # ours, and in brackets the paper's
        (
            [],
            {"table2": TABLE_2, "table4": TABLE_4},
            True,
            ["11.3 11.0 99.0", "2.39 2.70 2.04 2.67 8.00 9.00"],
        ),
        (
            [],
            {"table2": TABLE_2, "table2_seeds": TABLE_2.assign(mean=20.0, seeds=10)},
            True,
            ["10 20.0 11.0 20.0"],
        ),
    ],
)
def test_sentences_have_the_numbers_of_what_holds_and_what_does_not(
    claims, tables, simulated, numbers
):
    sentences = found(claims, tables, simulated=simulated)
    assert [" ".join(re.findall(r"\d+(?:\.\d+)?", sentence)) for sentence in sentences] == numbers


def test_errors_have_the_unit_of_their_table():
    (sentence,) = found([], {"table2": TABLE_2.assign(unit="N")}, simulated=False)
    assert re.findall(r" (\w+) for ", sentence) == ["N", "N"]
