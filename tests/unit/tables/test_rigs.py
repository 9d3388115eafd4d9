import numpy as np
import pytest

from fprc.tables import rig_errors, rigs_page

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
    runs = {"sweep/fprc/none": opened, "sweep/fprc_pd/identified": closed, "sweep/pd/printed": 30.0}
    return {"source": "sim", "rmse_deg": runs, "gains": {"identified": {"kp_kpa_per_deg": 4.0}}}


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
    )
    assert list(page.columns) == ["Number or claim", "Paper", "Rig dry", "Rig viscous"]
    last = page.iloc[-1]
    assert last["Number or claim"] == "C8: equal shares"
    assert (last["Rig dry"], last["Rig viscous"]) == ("undecided (fitted)", "undecided (predicted)")
    assert page["Rig dry"][0].endswith("+20 %")
