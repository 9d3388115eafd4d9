"""Cross-validation, choice of the best fold, and its test."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from numbers import Integral
from typing import Any, NamedTuple

import numpy as np
from sklearn.base import BaseEstimator, clone

from fprc.errors import EvaluationError
from fprc.evaluation.folds import Fold
from fprc.models import RidgeReadout, SequenceModel
from fprc.signals import rms

#: What a model learns from a log or is tested on: inputs of shape (n_samples, n_inputs), P_exp in
#: kPa, and the samples of each recording if there are several.
Samples = tuple[np.ndarray, np.ndarray] | tuple[np.ndarray, np.ndarray, Sequence[int] | None]


def rmse(truth: np.ndarray, prediction: np.ndarray) -> float:
    """Return the root mean square of the difference, in the unit of both.

    Raises
    ------
    EvaluationError
        The shapes differ, or the result is not a finite number.
    """
    if np.shape(truth) != np.shape(prediction):
        raise EvaluationError(f"the shapes {np.shape(truth)} and {np.shape(prediction)} differ")
    error = rms(truth - prediction)
    if not np.isfinite(error):
        raise EvaluationError("the model's output is not finite; check rho and alpha first")
    return error


@contextmanager
def refusals_of(model: BaseEstimator) -> Iterator[None]:
    """Turn a ValueError of a model into an EvaluationError that names the model."""
    try:
        yield
    except ValueError as error:
        raise EvaluationError(f"{type(model).__name__}: {error}") from error


class CrossValidated(NamedTuple):
    """Result of the cross-validation of one model."""

    train_rmse: tuple[float, ...]  #: per fold
    validation_rmse: tuple[float, ...]  #: per fold
    best: int  #: fold with the least sqrt(e_train^2 + e_val^2)
    fit: np.ndarray  #: output of the best fold's model for the whole log
    model: SequenceModel  #: trained on the best fold


class Prepared(NamedTuple):
    """Features of a model over some logs; readouts are fitted to rows of them and tested."""

    model: SequenceModel  #: not fitted
    features: BaseEstimator  #: fitted
    rows: Mapping[str, np.ndarray]  #: features of each log, of shape (n_samples, n_features)
    y: Mapping[str, np.ndarray]  #: P_exp of each log, kPa

    def readout(self, log: str) -> BaseEstimator:
        """Return the readout fitted to a log."""
        with refusals_of(self.model):
            return self.model.make_readout().fit(self.rows[log], self.y[log])

    def error(self, readout: BaseEstimator, log: str) -> float:
        """Return the RMSE of a fitted readout on a log, kPa."""
        return rmse(self.y[log], readout.predict(self.rows[log]))

    def fitted(self, readout: BaseEstimator) -> SequenceModel:
        """Return the fitted model with that readout."""
        return self.model.assembled(self.features, readout)

    def cross_validated(self, log: str, folds: Sequence[Fold]) -> CrossValidated:
        """Train once per fold and keep the best (Sec. III-D); the folds select rows of a log.

        A random readout has its own seed in every fold, which no other seed shares.
        """
        blocks = [self.rows[log]]
        return _cross_validated(self.model, self.features, lambda: blocks, self.y[log], folds)


def prepare(model: SequenceModel, logs: Mapping[str, Samples]) -> Prepared:
    """Compute the features of some logs, once per log and in the order of time.

    The features are fitted to the first log. EvaluationError: a log is too short for the taps.
    """
    first, *_ = next(iter(logs.values()))
    with refusals_of(model):
        features = model.make_features().fit(first)
        rows = {name: features.map_log(X, *lengths) for name, (X, _, *lengths) in logs.items()}
    return Prepared(model, features, rows, {name: log[1] for name, log in logs.items()})


def learn(model: SequenceModel, samples: Samples, folds: Sequence[Fold]) -> CrossValidated:
    """Cross-validate a model on one log; of a ridge regression's features a block is in memory."""
    X, y, *lengths = samples
    with refusals_of(model):
        features = model.make_features().fit(X)
    return _cross_validated(model, features, lambda: features.blocks(X, *lengths), y, folds)


def evaluate(
    model: SequenceModel, folds: Sequence[Fold], train: Samples, test: Samples
) -> dict[str, Any]:
    """Return the errors of all folds of a log, and that of the best fold's model on a test log.

    EvaluationError: a log is too short for the model, or an error is not finite.
    """
    prepared = prepare(model, {"train": train, "test": test})
    validated = prepared.cross_validated("train", folds)
    return {
        "train_rmse_kpa": validated.train_rmse,
        "validation_rmse_kpa": validated.validation_rmse,
        "test_rmse_kpa": prepared.error(validated.model.readout_, "test"),
    }


def _cross_validated(
    model: SequenceModel, features: BaseEstimator, blocks: Callable[[], Iterable[np.ndarray]],
    y: np.ndarray, folds: Sequence[Fold],
) -> CrossValidated:  # fmt: skip
    """Train once per fold and keep the best; ``blocks`` gives the features of all samples."""
    readout = model.make_readout()
    with refusals_of(model):
        if isinstance(readout, RidgeReadout) and _is_partition(folds, len(y)):
            readouts = readout.fit_complements(blocks(), y, [validation for _, validation in folds])
        else:
            # the next block may overwrite the one before
            rows = np.concatenate([block.copy() for block in blocks()])
            readouts = [
                _with_seed_of(clone(readout), i).fit(rows[train], y[train])
                for i, (train, _) in enumerate(folds)
            ]
        outputs = [np.column_stack([fit.predict(rows) for fit in readouts]) for rows in blocks()]
        fits = np.concatenate(outputs).T
        errors = [
            [rmse(y[part], fit[part]) for part in fold]
            for fit, fold in zip(fits, folds, strict=True)
        ]
    best = int(np.argmin(np.hypot(*np.transpose(errors))))
    train_rmse, validation_rmse = zip(*errors, strict=True)
    fitted = model.assembled(features, readouts[best])
    return CrossValidated(train_rmse, validation_rmse, best, fits[best], fitted)


def _is_partition(folds: Sequence[Fold], samples: int) -> bool:
    """Return whether each row validates in one fold and trains in all others."""
    validated = np.sort(np.concatenate([validation for _, validation in folds]))
    sizes = {len(train) + len(validation) for train, validation in folds}
    return sizes == {samples} and np.array_equal(validated, np.arange(samples))


def _with_seed_of(readout: BaseEstimator, fold: int) -> BaseEstimator:
    for key, seed in readout.get_params().items():
        # a nested readout, such as a pipeline, has keys with a prefix
        if key.split("__")[-1] == "random_state" and isinstance(seed, Integral):
            seed_of_fold = np.random.SeedSequence([int(seed), fold]).generate_state(1)[0]
            readout.set_params(**{key: int(seed_of_fold)})
    return readout
