"""Weight contributions of the FPRC's features (Sec. III-D, Fig. 9)."""

from collections.abc import Sequence

import numpy as np

from fprc.evaluation.crossval import fit_folds, refusals_of
from fprc.evaluation.folds import Fold
from fprc.models import SequenceModel
from fprc.models.recordings import transform_each


def normalised_weights(
    model: SequenceModel,
    X: np.ndarray,
    y: np.ndarray,
    folds: Sequence[Fold],
    lengths: Sequence[int] | None = None,
) -> np.ndarray:
    """Return the FPRC's absolute weights on normalised features; rows sum to 1 (Eqs. 13, 14).

    theta and the filtered P_o are each scaled to [0, 1] by their minimum and
    maximum in the training data. The model is then cross-validated as usual, and
    the weights are those of the best fold.

    Parameters
    ----------
    X : ndarray of shape (n_samples, 2)
        theta in deg, P_o in kPa.
    lengths : sequence of int, optional
        Samples of each recording in ``X``; by default it is one.

    Returns
    -------
    ndarray of shape (n_c, 1 + n_y + n_u)
        Bias, taps of theta_d, taps of the filtered P_o.
    """
    with refusals_of(model):
        rows = transform_each(model.make_features().fit(X), X, lengths)
        theta, p_o = rows[:, : model.n_y], rows[:, model.n_y :]
        normalised = np.hstack([_to_unit(theta), _to_unit(p_o)])
        folded = fit_folds(model.make_readout(), normalised, y, folds)
    weights = np.abs(folded.readout.W_out_)
    return weights / weights.sum(axis=1, keepdims=True)


def _to_unit(taps: np.ndarray) -> np.ndarray:
    # the taps of one signal share its minimum and maximum
    if taps.min() == taps.max():
        raise ValueError(f"a signal is {taps.min():g} throughout and cannot be normalised")
    return (taps - taps.min()) / (taps.max() - taps.min())
