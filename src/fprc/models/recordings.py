"""Several recordings at once: models restart at the first sample of each recording."""

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator


def are_several(X: Any) -> bool:
    """Return whether ``X`` is a list of recordings, not a table of samples."""
    return isinstance(X, list | tuple) and len(X) > 0 and np.ndim(X[0]) == 2


def joined(X: Any, y: Any = None) -> tuple[Any, Any, list[int] | None]:
    """Return inputs and output, and the lengths of several recordings; a list becomes one array.

    Raises
    ------
    ValueError
        ``X`` is a list, but ``y`` is not one of as long arrays; or a recording, which the message
        names, holds NaN or infinity.
    """
    if not are_several(X):
        return X, y, None
    each = [len(recording) for recording in X]
    if y is not None and list(map(np.shape, y)) != [(length,) for length in each]:
        raise ValueError(f"X has {len(X)} recordings; y must be a list of arrays of their lengths")
    for name, parts in {"X": X, "y": y or []}.items():
        for number, part in enumerate(parts, 1):
            if len(bad := np.argwhere(~np.isfinite(np.asarray(part, dtype=float)))):
                raise ValueError(
                    f"recording {number} of {len(X)}: {name} holds NaN or infinity at sample "
                    f"{bad[0, 0]}; interpolate or cut it"
                )
    # tables by the names of their columns
    whole = pd.concat(X) if isinstance(X[0], pd.DataFrame) else np.concatenate(X)
    return whole, None if y is None else np.concatenate(y), each


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
    if lengths is None:
        return features.transform(X)
    parts = np.split(X, np.cumsum(lengths)[:-1])
    if len(parts) == 1:
        return features.transform(X)
    rows = []
    for number, part in enumerate(parts, 1):
        try:
            rows.append(features.transform(part))
        except ValueError as error:
            raise ValueError(f"recording {number} of {len(parts)}: {error}") from error
    return np.concatenate(rows)
