"""Readouts of one model, fitted to any blocks of a log by sums of their moments."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from fprc.evaluation.crossval import refusals_of
from fprc.evaluation.folds import Fold
from fprc.models import SequenceModel, TakagiSugenoReadout
from fprc.models.fcm import fuzzy_c_means
from fprc.models.fprc import gaussian_memberships

#: An error below this share of the target's standard deviation counts as this share.
FLOOR = 1e-6
#: Keeps the equations of collinear features solvable; a share of the weight of all samples.
_TINY = 1e-11


class BlockReadouts:
    """Ridge or Takagi-Sugeno readouts of a model, each fitted without some blocks of a log.

    The blocks and their purged neighbours cut the log, of recordings with ``lengths``, into cells.
    The moments of each cell are computed once, so a fit without any blocks costs one sum and one
    solution. Features are computed in the order of time. The rules of a Takagi-Sugeno readout are
    placed once, by the inputs of the whole log; no target takes part in that. Predictions are
    clipped to the range of the training targets.

    ``folds`` are of ``split_blocks``. ``alphas`` are ridge parameters: shares of the weight of the
    training samples, on standardised features, without a penalty on the bias. None is the
    model's own, as it fits: features as they are, and the bias penalised too.
    """

    def __init__(
        self, model: SequenceModel, X: np.ndarray, y: np.ndarray, lengths: Sequence[int],
        folds: Sequence[Fold], alphas: Sequence[float] | None = None,
    ):  # fmt: skip
        readout: Any = model.make_readout()
        fit = self._blend = np.ones((len(y), 1))
        with refusals_of(model):
            features = model.make_features().fit(X).map_log(X, lengths)
            if isinstance(readout, TakagiSugenoReadout):
                how: Any = {"random_state": readout.random_state, "restarts": readout.restarts}
                clusters = fuzzy_c_means(features, readout.n_c, **how)
                fit = clusters.memberships**2
                self._blend = gaussian_memberships(features, clusters.centers, readout.sigma)
        self._own, self._alphas = readout.alpha, alphas
        if alphas is not None:
            spread = features.std(axis=0)
            moving = spread > 1e-9 * np.maximum(np.abs(features).max(axis=0), 1e-30)
            features = (features - features.mean(axis=0)) / np.where(moving, spread, 1.0)
        self._rows = np.column_stack([np.ones(len(y)), features])
        self._y, self.blocks = y, [block for _, block in folds]
        self._least = FLOOR * (float(y.std()) or 1.0)
        out = np.array([~np.isin(np.arange(len(y)), train) for train, _ in folds])
        begins = np.flatnonzero(np.any(out[:, 1:] != out[:, :-1], axis=0)) + 1
        cells = np.split(np.arange(len(y)), begins)
        self._without = out[:, [cell[0] for cell in cells]]
        self._ends = np.array([[y[cell].min(), y[cell].max()] for cell in cells])
        both = np.column_stack([self._rows, y])
        self._moments = np.array(
            [[(self._rows[k] * u[k, None]).T @ both[k] for u in fit.T] for k in cells]
        )
        self._all = self._moments.sum(axis=0)

    def errors(self, block: int, without: Sequence[int] = ()) -> np.ndarray:
        """Return the RMSE on a block for each alpha, fitted without it and further blocks.

        The samples that are purged around all these blocks do not train either.
        """
        gone = self._without[[block, *without]].any(axis=0)
        moments = self._all - self._moments[gone].sum(axis=0)
        gram, target = moments[..., :-1], moments[..., -1:]
        eye = np.eye(gram.shape[-1])
        penalties = [self._own * eye]
        if self._alphas is not None:
            slopes = np.diag(np.arange(len(eye)) > 0).astype(float)
            weight = gram[:, :1, :1]
            penalties = [weight * (alpha * slopes + _TINY * eye) for alpha in self._alphas]
        rows, y = self._rows[self.blocks[block]], self._y[self.blocks[block]]
        ends, outputs = self._ends[~gone], []
        for penalty in penalties:
            weights = np.linalg.solve(gram + penalty, target)[..., 0]
            outputs.append((self._blend[self.blocks[block]] * (rows @ weights.T)).sum(axis=1))
        misses = np.clip(outputs, ends[:, 0].min(), ends[:, 1].max()) - y
        return np.maximum(np.sqrt(np.mean(misses**2, axis=1)), self._least)
