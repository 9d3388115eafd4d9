"""Cross-validation, choice of the best fold, and its test."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from numbers import Integral
from typing import Any, NamedTuple

import numpy as np
from sklearn.base import BaseEstimator, clone

from fprc.errors import EvaluationError
from fprc.evaluation.folds import Fold
from fprc.evaluation.metrics import rmse
from fprc.models import SequenceModel
from fprc.models.learned import features_of
from fprc.models.recordings import transform_each

#: Most bytes of the features of a log; training takes up to twice as many.
MOST_BYTES = 2 << 30


@contextmanager
def refusals_of(model: BaseEstimator) -> Iterator[None]:
    """Turn a ValueError of a model into an EvaluationError that names the model."""
    try:
        yield
    except ValueError as error:
        raise EvaluationError(f"{type(model).__name__}: {error}") from error


class Folded(NamedTuple):
    """Errors of the folds, and the readout of the best one."""

    train_rmse: tuple[float, ...]  #: per fold
    validation_rmse: tuple[float, ...]  #: per fold
    best: int  #: fold with the least sqrt(e_train^2 + e_val^2)
    fit: np.ndarray  #: output of the best fold's readout for every row
    readout: BaseEstimator  #: trained on the best fold


class CrossValidated(NamedTuple):
    """Result of the cross-validation of one model."""

    train_rmse: tuple[float, ...]  #: per fold
    validation_rmse: tuple[float, ...]  #: per fold
    best: int  #: fold with the least sqrt(e_train^2 + e_val^2)
    fit: np.ndarray  #: output of the best fold's model for the whole log
    model: SequenceModel  #: trained on the best fold

    def errors(
        self, X: np.ndarray, y: np.ndarray, lengths: Sequence[int] | None = None
    ) -> dict[str, Any]:
        """Return the errors of all folds, and that of the best fold's model on a test log."""
        with refusals_of(self.model):
            rows = transform_each(self.model.features_, X, lengths)
            predicted = self.model.readout_.predict(rows)
        return {
            "train_rmse_kpa": self.train_rmse,
            "validation_rmse_kpa": self.validation_rmse,
            "test_rmse_kpa": rmse(y, predicted),
        }


Progress = Callable[[int, float, float], None]


def cross_validate(
    model: SequenceModel,
    X: np.ndarray,
    y: np.ndarray,
    folds: Sequence[Fold],
    progress: Progress = lambda fold, e_train, e_validation: None,
    lengths: Sequence[int] | None = None,
) -> CrossValidated:
    """Train ``model`` once per fold and keep the best (Sec. III-D).

    The features are computed once over the whole log, in the order of time;
    the folds select rows of them.

    Parameters
    ----------
    X : ndarray of shape (n_samples, n_inputs)
    y : ndarray of shape (n_samples,)
    progress : callable
        Called after each fold with its number, training and validation error.
    lengths : sequence of int, optional
        Samples of each recording in ``X``; by default it is one.

    Raises
    ------
    EvaluationError
        The log does not suit the model (too short for its taps, fewer samples than rules, more
        features than ``MOST_BYTES``), or an error is not finite.
    """
    with refusals_of(model):
        features = model.make_features().fit(X)
        most = MOST_BYTES // (8 * (features_of(features) or 1))
        if len(X) > most:
            raise ValueError(
                f"{len(X):,} samples; training it holds the features of all samples in memory, so "
                f"with its settings it takes at most {most:,}: use a shorter log"
            )
        rows = transform_each(features, X, lengths)
    return validate_rows(model, features, rows, y, folds, progress)


def validate_rows(
    model: SequenceModel,
    features: BaseEstimator,
    rows: np.ndarray,
    y: np.ndarray,
    folds: Sequence[Fold],
    progress: Progress = lambda fold, e_train, e_validation: None,
) -> CrossValidated:
    """Do as ``cross_validate``, given the features of the log as ``rows``."""
    with refusals_of(model):
        folded = fit_folds(model.make_readout(), rows, y, folds, progress)
    return CrossValidated(*folded[:4], model.assembled(features, folded.readout))


def fit_folds(
    readout: BaseEstimator,
    rows: np.ndarray,
    y: np.ndarray,
    folds: Sequence[Fold],
    progress: Progress = lambda fold, e_train, e_validation: None,
) -> Folded:
    """Fit a copy of ``readout`` to each fold's rows and keep the best.

    A random readout has its own seed in every fold, which no other seed shares.
    """
    errors, fits = [], []
    for i, fold_readout in enumerate(_fitted(readout, rows, y, folds)):
        predicted = fold_readout.predict(rows)
        fits.append((predicted, fold_readout))
        e_train, e_validation = (rmse(y[part], predicted[part]) for part in folds[i])
        errors.append((e_train, e_validation))
        progress(i, e_train, e_validation)
    best = int(np.argmin([np.hypot(*pair) for pair in errors]))
    train_rmse, validation_rmse = zip(*errors, strict=True)
    return Folded(train_rmse, validation_rmse, best, *fits[best])


def _fitted(
    readout: BaseEstimator, rows: np.ndarray, y: np.ndarray, folds: Sequence[Fold]
) -> Iterator[BaseEstimator]:
    if hasattr(readout, "fit_complements") and _is_partition(folds, len(y)):
        yield from readout.fit_complements(rows, y, [validation for _, validation in folds])
    else:
        for i, (train, _) in enumerate(folds):
            yield _with_seed_of(clone(readout), i).fit(rows[train], y[train])


def _is_partition(folds: Sequence[Fold], samples: int) -> bool:
    """Return whether each row validates in one fold and trains in all others."""
    validated = np.sort(np.concatenate([validation for _, validation in folds]))
    return np.array_equal(validated, np.arange(samples)) and all(
        np.array_equal(np.sort(np.concatenate(fold)), np.arange(samples)) for fold in folds
    )


def _with_seed_of(readout: BaseEstimator, fold: int) -> BaseEstimator:
    for key, seed in readout.get_params().items():
        # a nested readout, such as a pipeline, has keys with a prefix
        if key.split("__")[-1] == "random_state" and isinstance(seed, Integral):
            own = np.random.SeedSequence([int(seed), fold]).generate_state(1)[0]
            readout.set_params(**{key: int(own)})
    return readout
