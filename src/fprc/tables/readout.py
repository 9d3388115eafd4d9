"""Table on the value of the reservoir's readout."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from fprc.signals import mean_and_std
from fprc.tables.text import spread

#: P_o and its substitutes, as readers see them.
READOUT_NAMES = {
    "none": "no readout (Fuzzy-linear)",
    "p_o": "P_o of the reservoir (FPRC)",
    "theta": "theta in place of P_o: the low-pass alone",
    "shifted": "P_o shifted in time",
}

_PHASES = ("train", "validation", "test")


def readout(report: Mapping[str, Any]) -> pd.DataFrame:
    """Errors of FPRC with each readout, tidy: mean and deviation over folds."""
    rows = []
    for cell in report["cells"]:
        row = {"split": cell["split"], "readout": cell["readout"], **report["own"]}
        for phase in _PHASES:
            row[f"{phase}_rmse"], std = mean_and_std(cell[f"{phase}_rmse_kpa"])
            if phase != "test":
                row[f"{phase}_std"] = std
        rows.append(row | {"unit": report["unit"], "source": report["source"]})
    return pd.DataFrame(rows)


def readout_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the readouts as a page."""
    return pd.DataFrame(
        {
            "Readout": READOUT_NAMES[row.readout],
            "Folds": row.split,
            f"Training [{row.unit}]": spread(row.train_rmse, row.train_std),
            f"Validation [{row.unit}]": spread(row.validation_rmse, row.validation_std),
            f"Test [{row.unit}]": spread(row.test_rmse, None),
        }
        for row in table.itertuples()
    )
