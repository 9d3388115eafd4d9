from fprc.studies.beyond.measurements import capacities, measured


def test_model_that_could_not_be_judged_leaves_no_row():
    models = {"fprc": {"failed": "it diverged"}, "bank": {"train": 9.0, "forward/-2": 10}}
    cells = [{"unit": 3, "seed": 601, "models": models}]
    assert measured([{"name": "dry", "cells": cells}]).to_numpy().tolist() == [
        ["dry", 3, 601, "bank", "train", 9.0], ["dry", 3, 601, "bank", "forward/-2", 10.0]
    ]  # fmt: skip


def test_nonlinear_capacity_is_that_of_degree_two_and_above():
    found = {"states": 5, "by_degree": {"1": 2.0, "2": 1.5, "3": 0.5}}
    cells = [{"unit": 0, "seed": 601, "sets": {"p_o": found}}]
    table = capacities([{"name": "dry", "capacity": cells}, {"name": "drawn"}])
    assert set(table["world"]) == {"dry"}
    assert dict(zip(table["quantity"], table["value"], strict=True)) == {
        "memory": 2.0, "total": 4.0, "degree 1": 2.0, "degree 2": 1.5, "degree 3": 0.5,
        "nonlinear": 2.0,
    }  # fmt: skip
