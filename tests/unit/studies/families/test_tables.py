import numpy as np
import pytest

from fprc.studies.families.tables import rig_errors, sums_of

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
                "unit": "kPa",
                "source": "sim",
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


def test_sums_are_of_each_table_and_loop(table):
    sums = sums_of(table)
    off = table.set_index("number")["deviation"].abs()
    tables = off[~off.index.str.startswith("Table IV")]
    assert sums["median"] == pytest.approx(np.median(tables))
    assert sums["largest"] == pytest.approx(tables.max())
    assert sums["open_loop"] == pytest.approx(0.0)
    assert sums["closed_loop"] == sums["closed_loop_median"] == pytest.approx(0.2)
