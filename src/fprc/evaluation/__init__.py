"""Models on logs: folds, errors, cross-validation, execution times."""

from fprc.evaluation.crossval import CrossValidated, Prepared, evaluate, prepare, rmse
from fprc.evaluation.folds import settled_rmse, split_rows
from fprc.evaluation.timing import time_models

__all__ = [
    "CrossValidated",
    "Prepared",
    "evaluate",
    "prepare",
    "rmse",
    "settled_rmse",
    "split_rows",
    "time_models",
]
