"""Weight contributions of the FPRC's features (Sec. III-D, Fig. 9)."""

from collections.abc import Sequence

import numpy as np
from sklearn.base import clone

from fprc.evaluation.crossval import Prepared, Samples, prepare, refusals_of
from fprc.evaluation.folds import Fold
from fprc.models import SequenceModel


def normalised_weights(model: SequenceModel, log: Samples, folds: Sequence[Fold]) -> np.ndarray:
    """Return the FPRC's absolute weights on normalised features; rows sum to 1 (Eqs. 13, 14).

    The model is cross-validated as usual on features as ``normalised`` returns them, and the
    weights are those of the best fold.

    Parameters
    ----------
    log : Samples
        Its inputs are theta in deg and P_o in kPa.

    Returns
    -------
    ndarray of shape (n_c, 1 + n_y + n_u)
        Bias, taps of theta_d, taps of the filtered P_o.
    """
    prepared = normalised(prepare(model, {"train": log}), "train")
    judged = prepared.cross_validated("train", folds)
    return shares_of(judged.model.readout_.W_out_)


def normalised(prepared: Prepared, log: str) -> Prepared:
    """Return a prepared FPRC with features of one log scaled to [0, 1] (Eq. 13).

    theta and the filtered P_o are each scaled by their minimum and maximum. The ridge parameter is
    that of features in deg and kPa. It is divided by the product of both ranges, so that it counts
    as much as on them (docs/decisions/0024-weights.md).

    Raises
    ------
    EvaluationError
        A signal is constant.
    """
    model, rows = prepared.model, prepared.rows[log]
    taps = rows[:, : model.n_y], rows[:, model.n_y :]  # those of one signal share its range
    ranges = [float(np.ptp(of_signal)) for of_signal in taps]
    with refusals_of(model):
        if 0.0 in ranges:
            constant = taps[ranges.index(0.0)].min()
            raise ValueError(f"a signal is {constant:g} throughout and cannot be normalised")
    scaled = [(t - t.min()) / width for t, width in zip(taps, ranges, strict=True)]
    weaker = clone(model).set_params(alpha=model.alpha / np.prod(ranges))
    return prepared._replace(model=weaker, rows={log: np.hstack(scaled)})


def shares_of(W_out: np.ndarray) -> np.ndarray:
    """Return the absolute weights as shares of their rule."""
    weights = np.abs(W_out)
    return weights / weights.sum(axis=1, keepdims=True)
