import math

import pytest

from fprc.studies.beyond.measurements import capacities, measured

CELL = {"unit": 3, "seed": 601}


def values(**report):
    family = {"cells": [CELL | {"models": {"fprc": report}}]}
    table = measured(family)
    return dict(zip(table["measure"], table["value"], strict=True))


def test_numbers_are_named_by_their_measure():
    found = values(
        forward={"train_rmse_kpa": 9.0, "test_rmse_kpa": 10.0},
        reversed={"train_rmse_kpa": 9.0, "test_rmse_kpa": 20},
        open_loop_deg={"sine_0p2": 1.0, "sine_0p5": 2.0, "sweep": 3.0, "complex": 4.0},
        shifted={"-2.0": 15.0, "0.5": 11.0},
        disturbed={"drift": 12.0},
    )
    assert found.pop("open_loop") == pytest.approx(math.sqrt(7.5))
    assert found == {
        "train": 9.0, "forward": 10.0, "reversed": 20.0, "shifted/-2": 15.0, "shifted/0.5": 11.0,
        "disturbed/drift": 12.0,
    }  # fmt: skip


def test_model_that_could_not_be_judged_leaves_no_row():
    assert values(failed="it diverged") == {}


def test_nonlinear_capacity_is_that_of_degree_two_and_above():
    found = {"states": 5, "by_degree": {"1": 2.0, "2": 1.5, "3": 0.5}}
    table = capacities({"capacity": [{"unit": 0, "seed": 601, "sets": {"p_o": found}}]})
    assert dict(zip(table["quantity"], table["value"], strict=True)) == {
        "memory": 2.0, "total": 4.0, "degree 1": 2.0, "degree 2": 1.5, "degree 3": 0.5,
        "nonlinear": 2.0,
    }  # fmt: skip
    assert capacities({"capacity": None}).empty
