import numpy as np
import pandas as pd
import pytest

from fprc.studies.families.rigs import (
    deviations_of,
    rig_errors,
    rigs_answer,
    rigs_page,
    within_limits,
)

PUBLISHED = {
    "table_2_models": {"esn": {"train_rmse_kpa": [10.0, 0.1], "validation_rmse_kpa": [10.0, 0.1],
                               "test_rmse_kpa": 20.0}},
    "table_3_reversed": {"esn": {"train_rmse_kpa": [8.0, 0.1], "validation_rmse_kpa": [8.0, 0.1],
                                 "test_rmse_kpa": 40.0}},
    "table_4_tracking_rmse_deg": {"fprc": {"sweep": 2.0}, "fprc_pd": {"sweep": 1.0}},
}  # fmt: skip


def models(train, test):
    return {
        "source": "sim",
        "models": [
            {
                "model": "esn",
                "trained_on": log,
                "train_rmse_kpa": [train - 1.0, train + 1.0],
                "validation_rmse_kpa": [train, train],
                "test_rmse_kpa": test,
            }
            for log in ("sweep", "complex")
        ],
    }


def control(opened, closed):
    runs = {"sweep/fprc": opened, "sweep/fprc_pd": closed, "sweep/pd": 30.0}
    return {"source": "sim", "rmse_deg": runs}


@pytest.fixture
def table():
    return rig_errors(
        [models(11.0, 18.0), models(13.0, 22.0)], [control(1.5, 1.1), control(2.5, 1.3)], PUBLISHED
    )


def test_every_printed_error_has_a_row_with_its_deviation(table):
    assert len(table) == 2 * 3 + 2
    means = dict(zip(table["number"], table["mean"], strict=True))
    assert means["Table II, ESN, Training RMSE [kPa]"] == pytest.approx(12.0)
    assert means["Table III, ESN, Test RMSE [kPa]"] == pytest.approx(20.0)
    assert means["Table IV, FPRC, Sweep [deg]"] == pytest.approx(2.0)
    np.testing.assert_allclose(table["deviation"], table["mean"] / table["published"] - 1.0)
    away = table.set_index("number")["deviation"]
    assert away["Table III, ESN, Test RMSE [kPa]"] == pytest.approx(-0.5)
    assert (table["low"] < table["mean"]).all()


def test_page_has_a_column_per_rig_and_says_what_was_fitted(table):
    ledger = {"id": "C8", "claim": "equal shares", "verdict": "undecided"}
    page = rigs_page(
        {"dry": table, "viscous": table.assign(mean=2 * table["mean"])},
        {"dry": [ledger | {"rig": "fitted"}], "viscous": [ledger | {"rig": "predicted"}]},
        {"dry": 0.1, "viscous": 0.2},
    )
    assert list(page.columns) == ["Number or claim", "Paper", "Rig dry", "Rig viscous"]
    last = page.iloc[-1]
    assert last["Number or claim"] == "C8: equal shares"
    assert (last["Rig dry"], last["Rig viscous"]) == ("undecided (fitted)", "undecided (predicted)")
    assert page["Rig dry"][0].endswith("+20 %")


@pytest.mark.parametrize(
    ("deviations", "met"),
    [
        ([0.05, -0.15, 0.0, 0.15, -0.35], [1, 1, 1, 1, 1, 1, 1]),
        ([0.051, -0.151, 0.0, 0.15, 0.35], [0, 0, 1, 1, 0, 1, 0]),
        ([0.051, -0.1, 0.06, 0.15, -0.351], [0, 1, 1, 0, 0, 0, 0]),
        ([0.01, -0.16, 0.0, -0.151, 0.3], [1, 0, 0, 1, 0, 0, 0]),
    ],
)
def test_limits_are_on_the_deviations_of_each_table(deviations, met):
    numbers = ["Table II, a", "Table III, b", "Table II, c"]
    numbers += ["Table IV, FPRC, d", "Table IV, FPRC+PD, e"]
    found = within_limits(pd.DataFrame({"number": numbers, "deviation": deviations}))
    assert list(found.values()) == [bool(each) for each in met]


@pytest.mark.parametrize("deviation", [[0.1, 0.2, np.nan], [0.1, 0.2]])
def test_deviation_that_is_missing_is_refused(deviation):
    numbers = ["Table II, ESN", "Table IV, FPRC, Sweep", "Table IV, FPRC+PD, Sweep"]
    errors = pd.DataFrame({"number": numbers[: len(deviation)], "deviation": deviation})
    with pytest.raises(ValueError, match="is missing"):
        deviations_of(errors)


def test_page_sums_the_errors_up(table):
    ledger = [{"id": "C8", "claim": "equal shares", "verdict": "reproduced", "rig": "fitted"}]
    page = rigs_page({"dry": table}, {"dry": ledger}, {"dry": 0.126})
    page = page.iloc[len(table) :]  # after the single errors
    off = table["deviation"].abs()[:6]
    assert page["Rig dry"][:3].to_list() == [
        "13 % (rms)", f"{100 * off.median():.0f} %", f"{100 * off.max():.0f} %"
    ]  # fmt: skip
    last = table.iloc[-1]
    assert last["number"].startswith("Table IV, FPRC+PD")
    closed = page.set_index("Number or claim").loc["Table IV, closed loop, largest deviation"]
    assert closed["Rig dry"] == f"{100 * abs(last['deviation']):.0f} %"
    assert len(page) == 6 + 1
    assert page["Number or claim"].iloc[-1] == "C8: equal shares"


def test_answer_says_what_the_reservoir_is_worth_on_each_rig_and_set(table):
    ledger = [
        {"id": name, "claim": "it is so", "rig": "fitted", "verdict": verdict, "ours": ours}
        for name, verdict, ours in (
            ("C1", "reproduced", "a: 1; b: 2"),
            ("B1", "undecided", "FPRC / FPRC on low-passed theta_d, test: 0.9 (0.7 to 1.1)"),
            ("C13a", "reproduced", "c: 3"),
        )
    ]
    summary = {
        "drawn": "rigs from a hat; nothing was asked of them",
        "deviation": 0.123,
        "worth": [0.95, 0.5, 2.0],
        "claims": [{"id": "B1", "holds": 3, "rigs": 4, "share": 0.75, "low": 0.3, "high": 0.95}],
    }
    page = rigs_answer(rigs_page({"dry": table}, {"dry": ledger}, {"dry": 0.126}), [summary])
    open_loop = table["deviation"][table["number"].str.startswith("Table IV, FPRC,")].abs()
    assert page.to_numpy().tolist() == [
        [
            "Rig dry",
            "13 % (rms)",
            f"{100 * open_loop.max():.0f} % at most",
            "2 reproduced",
            "0.9 (0.7 to 1.1)",
            "undecided (fitted)",
        ],
        [
            "4 rigs from a hat",
            "12 % (rms)",
            "-",
            "-",
            "median 0.950, 95 % of the rigs 0.500 to 2.00",
            "holds on 3: 75 % (30 to 95)",
        ],
    ]
