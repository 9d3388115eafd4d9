import pytest

from fprc.recordings.competitors_table import competitors_page, competitors_table

REPORT = {
    "unit": "N",
    "source": "import",
    "cells": [
        {"model": "esn", "reason": "too long"},
        {"model": "fprc", "validation_rmse_kpa": [2.0, 4.0], "test_rmse_kpa": 5.0},
        {"model": "bank", "validation_rmse_kpa": [1.0, 2.0], "test_rmse_kpa": 6.0},
    ],
}


def test_best_model_is_first_and_one_without_errors_last():
    table = competitors_table(REPORT)
    assert list(table["model"]) == ["bank", "fprc", "esn"]
    assert list(table["block_rmse"][:2]) == [1.5, 3.0]
    assert table["block_std"][1] == pytest.approx(2**0.5)
    assert list(table["blocks"]) == [2, 2, 0]


def test_page_has_the_reason_in_place_of_errors():
    page = competitors_page(competitors_table(REPORT))
    assert list(page.columns) == ["Model", "Blocks [N]", "Test [N]"]
    assert list(page.iloc[1]) == ["FPRC", "3.00 ± 1.41", "5.00"]
    assert list(page.iloc[2]) == ["ESN", "too long", ""]
