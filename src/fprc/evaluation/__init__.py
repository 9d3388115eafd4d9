"""Judging models: folds, errors, cross-validation, execution times."""

from fprc.evaluation.crossval import CrossValidated, cross_validate, evaluate, rmse
from fprc.evaluation.folds import split_rows
from fprc.evaluation.timing import time_models

__all__ = ["CrossValidated", "cross_validate", "evaluate", "rmse", "split_rows", "time_models"]
