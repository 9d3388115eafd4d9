"""Several recordings at once: models restart at the first sample of each recording."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator
from sklearn.utils.validation import validate_data


def are_several(X: Any) -> bool:
    """Return whether ``X`` is a list of recordings, not a table of samples."""
    return isinstance(X, list | tuple) and len(X) > 0 and np.ndim(X[0]) == 2


def join_recordings(
    model: BaseEstimator, X: Any, y: Any, lengths: ArrayLike | None, *, first: bool = False
) -> tuple[np.ndarray, np.ndarray | None, list[int]]:
    """Return checked inputs and output, one recording after the other, and their lengths.

    Parameters
    ----------
    model : estimator
        Has the number and the names of the columns.
    X : array-like of shape (n_samples, n_inputs), or list of them
    y : array-like of shape (n_samples,), list of them, or None
    lengths : array-like of int, or None
        Number of samples of each recording in ``X``, if ``X`` is not a list.
    first : bool, default=False
        Whether the model is trained anew: it learns the columns, and ``y`` must be given.

    Raises
    ------
    ValueError
        A recording is wrong, which the message names, or ``lengths`` are wrong.
    """
    if not are_several(X):
        X, y = _checked(model, X, y, first)
        return X, y, checked_lengths(lengths, len(X))
    if lengths is not None:
        raise ValueError("X is a list of recordings, so lengths must be left out")
    if y is not None and (len(y) != len(X) or np.ndim(y[0]) == 0):
        raise ValueError(f"X has {len(X)} recordings; y must be a list of as many arrays")
    outputs = [None] * len(X) if y is None else y
    pairs = []
    for i in range(len(X)):
        with naming(i, len(X)):
            pairs.append(_checked(model, X[i], outputs[i], first and i == 0))
    inputs, targets = zip(*pairs, strict=True)
    whole = None if y is None else np.concatenate(targets)
    return np.concatenate(inputs), whole, [len(recording) for recording in inputs]


def _checked(
    model: BaseEstimator, X: ArrayLike, y: ArrayLike | None, first: bool
) -> tuple[np.ndarray, np.ndarray | None]:
    if y is None and not first:
        return validate_data(model, X, reset=False, dtype=np.float64), None
    return validate_data(model, X, y, reset=first, y_numeric=True, dtype=np.float64)


def checked_lengths(lengths: ArrayLike | None, samples: int) -> list[int]:
    """Return lengths of recordings as a list; ``None`` is one recording.

    Raises
    ------
    ValueError
        They are not whole numbers above 0, or do not add up to ``samples``.
    """
    if lengths is None:
        return [samples]
    numbers = np.asarray(lengths)
    if numbers.ndim != 1 or numbers.dtype.kind not in "iu" or not np.all(numbers > 0):
        raise ValueError(f"lengths = {lengths}; must be a list of whole numbers above 0")
    if numbers.sum() != samples:
        raise ValueError(f"lengths = {lengths} add up to {numbers.sum()}; X has {samples} samples")
    return numbers.tolist()


def split_recordings(values: np.ndarray, lengths: Sequence[int]) -> list[np.ndarray]:
    """Split values of joined recordings into one array per recording."""
    edges = np.cumsum([0, *lengths]).tolist()
    return [values[first:last] for first, last in pairwise(edges)]


def transform_each(
    features: BaseEstimator, X: np.ndarray, lengths: ArrayLike | None = None
) -> np.ndarray:
    """Return the features of each recording, computed only from the samples of that recording.

    Parameters
    ----------
    features : estimator
        Fitted feature map.
    X : ndarray of shape (n_samples, n_inputs)
    lengths : array-like of int, or None
        Number of samples of each recording; None is one recording.

    Raises
    ------
    ValueError
        A recording, which the message names, is shorter than the taps.
    """
    parts = split_recordings(X, checked_lengths(lengths, len(X)))
    if len(parts) == 1:
        return features.transform(X)
    rows = []
    for i, part in enumerate(parts):
        with naming(i, len(parts)):
            rows.append(features.transform(part))
    return np.concatenate(rows)


@contextmanager
def naming(recording: int, of: int) -> Iterator[None]:
    """Put the number of the recording, counted from 1, before the text of a ValueError."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"recording {recording + 1} of {of}: {error}") from error
