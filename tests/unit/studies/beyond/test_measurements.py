from fprc.studies.beyond.measurements import measured


def test_model_that_could_not_be_judged_leaves_no_row():
    models = {"fprc": {"failed": "it diverged"}, "bank": {"train": 9.0, "forward/-2": 10}}
    cells = [{"unit": 3, "seed": 601, "models": models}]
    assert measured([{"name": "dry", "cells": cells}]).to_numpy().tolist() == [
        ["dry", 3, 601, "bank", "train", 9.0], ["dry", 3, 601, "bank", "forward/-2", 10.0]
    ]  # fmt: skip
