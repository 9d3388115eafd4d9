"""An unfitted estimator as its class and its parameters."""

from typing import Any

import numpy as np
from sklearn.base import BaseEstimator


def describe(value: Any, *, seeds: bool = True) -> Any:
    """Return an estimator as a dict of class and parameters, at any depth.

    Arrays and tuples become lists, numbers of NumPy become Python's; two estimators are equal
    if their descriptions are. Any other value stays as it is.

    Parameters
    ----------
    seeds : bool, default=True
        Whether the parameters include ``random_state``.
    """
    if isinstance(value, BaseEstimator):
        parameters = value.get_params(deep=False)
        kept = {key: value for key, value in parameters.items() if seeds or key != "random_state"}
        return {"class": type(value), "parameters": describe(kept, seeds=seeds)}
    if isinstance(value, dict):
        return {key: describe(part, seeds=seeds) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [describe(part, seeds=seeds) for part in value]
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value
