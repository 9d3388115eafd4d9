"""Error measures of predictions."""

import numpy as np

from fprc.errors import EvaluationError
from fprc.signals import rms


def rmse(truth: np.ndarray, prediction: np.ndarray) -> float:
    """Return the root mean square of the difference, in the unit of both.

    Raises
    ------
    EvaluationError
        The shapes differ, or the result is not a finite number.
    """
    if np.shape(truth) != np.shape(prediction):
        raise EvaluationError(
            f"truth has the shape {np.shape(truth)}, but the prediction {np.shape(prediction)}"
        )
    error = rms(truth - prediction)
    if not np.isfinite(error):
        raise EvaluationError(
            f"the RMSE over {len(truth)} samples is {error}: the model's output is not finite; "
            "check its settings, rho and alpha first"
        )
    return error
