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
    ("claims", "tables", "simulated", "sentences"),
    [
        ([], {}, True, []),
        (
            ledger(predicted=[GOOD, BAD, OPEN], fitted=[GOOD], half_fitted=[BAD], timed=[BAD]),
            {},
            True,
            [
                "We reproduce 1 of 3 claims of the paper that the simulated rig was not fitted to "
                "(1 not reproduced, 1 undecided), 1 of 2 that the rig was fitted to at least in "
                "part (1 not reproduced) and 0 of 1 on execution times (1 not reproduced)."
            ],
        ),
        (
            ledger(predicted=[GOOD, GOOD], assumed=[GOOD], timed=[GOOD]),
            {},
            False,
            [
                "We reproduce 3 of 3 claims of the paper on accuracy and control and 1 of 1 on "
                "execution times."
            ],
        ),
        (
            [],
            {"table2": TABLE_2, "table4": TABLE_4},
            True,
            [
                "The test RMSE in Table II is 11.3 kPa for FPRC (paper: 11.0) and 99.0 kPa for "
                "Mine.",
                "The RMSE of tracking in Table IV is 2.39 to 2.70 deg for FPRC (paper: 2.04 to "
                "2.67) and 8.00 to 9.00 deg for PD.",
            ],
        ),
        (
            [],
            {"table2": TABLE_2, "table2_seeds": TABLE_2.assign(mean=20.0, seeds=10)},
            True,
            [
                "The test RMSE in Table II, mean over 10 seeds, is 20.0 kPa for FPRC (paper: 11.0) "
                "and 20.0 kPa for Mine."
            ],
        ),
    ],
)
def test_sentences_say_what_holds_and_what_does_not(claims, tables, simulated, sentences):
    assert found(claims, tables, simulated=simulated) == sentences
