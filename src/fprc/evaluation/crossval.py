"""Cross-validation, choice of the best fold, and its test."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from numbers import Integral
from typing import NamedTuple

import numpy as np
from sklearn.base import BaseEstimator, clone

from fprc.errors import EvaluationError
from fprc.evaluation.folds import Fold
from fprc.evaluation.metrics import rmse
from fprc.models import SequenceModel


@contextmanager
def refusals_of(model: BaseEstimator) -> Iterator[None]:
    """Turn what a model refuses into an error that names it."""
    try:
        yield
    except ValueError as error:
        raise EvaluationError(f"{type(model).__name__}: {error}") from error


class Folded(NamedTuple):
    """What the folds gave, and the readout of the best one."""

    train_rmse: tuple[float, ...]  #: per fold
    validation_rmse: tuple[float, ...]  #: per fold
    best: int  #: fold with the least sqrt(e_train^2 + e_val^2)
    readout: BaseEstimator  #: trained on the best fold


class Judgement(NamedTuple):
    """What cross-validation found of one model."""

    train_rmse: tuple[float, ...]  #: per fold
    validation_rmse: tuple[float, ...]  #: per fold
    best: int  #: fold with the least sqrt(e_train^2 + e_val^2)
    model: SequenceModel  #: trained on the best fold

    def test_rmse(self, X: np.ndarray, y: np.ndarray) -> float:
        """Error of the best fold's model on another log."""
        with refusals_of(self.model):
            return rmse(y, self.model.predict(X))


Progress = Callable[[int, float, float], None]


def cross_validate(
    model: SequenceModel,
    X: np.ndarray,
    y: np.ndarray,
    folds: Sequence[Fold],
    progress: Progress = lambda fold, e_train, e_validation: None,
) -> Judgement:
    """Train ``model`` once per fold and keep the best (Sec. III-D).

    The features are computed once over the whole log, in the order of time;
    the folds choose rows of them.

    Parameters
    ----------
    X : ndarray of shape (n_samples, n_inputs)
    y : ndarray of shape (n_samples,)
    progress : callable
        Called with fold, training and validation error as folds end.

    Raises
    ------
    EvaluationError
        The log does not suit the model (too short for its taps, fewer samples
        than rules), or an error is not finite.
    """
    with refusals_of(model):
        features = model.make_features().fit(X)
        folded = fit_folds(model.make_readout(), features.transform(X), y, folds, progress)
    return Judgement(*folded[:3], model.assembled(features, folded.readout))


def fit_folds(
    readout: BaseEstimator,
    rows: np.ndarray,
    y: np.ndarray,
    folds: Sequence[Fold],
    progress: Progress = lambda fold, e_train, e_validation: None,
) -> Folded:
    """Fit a copy of ``readout`` to each fold's rows and keep the best.

    A readout that is random starts differently in every fold, at
    ``random_state + fold``.
    """
    errors, fitted = [], []
    for i, (train, validation) in enumerate(folds):
        fitted.append(_started(clone(readout), i).fit(rows[train], y[train]))
        e_train = rmse(y[train], fitted[i].predict(rows[train]))
        e_validation = rmse(y[validation], fitted[i].predict(rows[validation]))
        errors.append((e_train, e_validation))
        progress(i, e_train, e_validation)
    best = int(np.argmin([np.hypot(*pair) for pair in errors]))
    train_rmse, validation_rmse = zip(*errors, strict=True)
    return Folded(train_rmse, validation_rmse, best, fitted[best])


def _started(readout: BaseEstimator, fold: int) -> BaseEstimator:
    seed = readout.get_params().get("random_state")
    if isinstance(seed, Integral):
        readout.set_params(random_state=seed + fold)
    return readout
