"""Weight contributions of the FPRC's features (Sec. III-D, Fig. 9)."""

from collections.abc import Sequence

import numpy as np

from fprc.evaluation.crossval import Samples, prepare, refusals_of
from fprc.evaluation.folds import Fold
from fprc.models import SequenceModel


def normalised_weights(model: SequenceModel, log: Samples, folds: Sequence[Fold]) -> np.ndarray:
    """Return the FPRC's absolute weights on normalised features; rows sum to 1 (Eqs. 13, 14).

    theta and the filtered P_o are each scaled to [0, 1] by their minimum and
    maximum in the training data. The model is then cross-validated as usual, and
    the weights are those of the best fold.

    Parameters
    ----------
    log : Samples
        Its inputs are theta in deg and P_o in kPa.

    Returns
    -------
    ndarray of shape (n_c, 1 + n_y + n_u)
        Bias, taps of theta_d, taps of the filtered P_o.
    """
    prepared = prepare(model, {"train": log})
    rows = prepared.rows["train"]
    with refusals_of(model):
        normalised = to_unit(rows, model.n_y)
    judged = prepared._replace(rows={"train": normalised}).cross_validated("train", folds)
    return shares_of(judged.model.readout_.W_out_)


def to_unit(rows: np.ndarray, n_y: int) -> np.ndarray:
    """Return the taps of theta, the first ``n_y``, and those of P_o, both scaled to [0, 1]."""
    return np.hstack([_to_unit(rows[:, :n_y]), _to_unit(rows[:, n_y:])])


def shares_of(W_out: np.ndarray) -> np.ndarray:
    """Return the absolute weights as shares of their rule."""
    weights = np.abs(W_out)
    return weights / weights.sum(axis=1, keepdims=True)


def _to_unit(taps: np.ndarray) -> np.ndarray:
    # the taps of one signal share its minimum and maximum
    if taps.min() == taps.max():
        raise ValueError(f"a signal is {taps.min():g} throughout and cannot be normalised")
    return (taps - taps.min()) / (taps.max() - taps.min())
