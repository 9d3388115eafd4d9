"""A model with memory: a sequential feature map, and a readout of single rows."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from copy import deepcopy
from typing import Any, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator, RegressorMixin, clone
from sklearn.utils.validation import check_is_fitted, validate_data

from fprc.models.limits import Array, training_data

Part = TypeVar("Part", bound=BaseEstimator)

#: Most weights of a readout that learns online: its covariance has the square of them.
MOST_WEIGHTS = 512


class SequenceModel(RegressorMixin, BaseEstimator, ABC):
    """Base of the feedforward models: rows of ``X`` are samples in time.

    Shuffled rows, as of ``KFold(shuffle=True)``, are wrong without a word: the model takes each row
    for the next sample. In scikit-learn's tools use ``TimeSeriesSplit``. The features depend on the
    history of the log, the readout on single rows. Cross-validation therefore computes the features
    once and fits one readout per fold; ``assembled`` joins the two into a model. A fitted model has
    them in the attributes ``features_`` and ``readout_``.
    """

    @abstractmethod
    def make_features(self) -> BaseEstimator:
        """Return the unfitted feature map."""

    @abstractmethod
    def make_readout(self) -> BaseEstimator:
        """Return the unfitted readout."""

    def _part(self, cls: type[Part], **settings: Any) -> Part:
        """Return an unfitted part with the model's values of all parameters but the settings."""
        part, own = cls(**settings), self.get_params(deep=False)
        shared = part.get_params(deep=False).keys() & own.keys() - settings.keys()
        return part.set_params(**{name: own[name] for name in shared})

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Train on a log; ``fprc.evaluation.prepare`` also takes several recordings.

        ``X`` has the samples in the order of time, at least as many as taps; ``y`` is P_exp, kPa.
        """
        rows, targets = training_data(self, X, y)
        self.features_ = self.make_features().fit(rows)
        readout = self.make_readout()
        if hasattr(readout, "fit_blocks"):
            self.readout_ = readout.fit_blocks(self.features_.blocks(rows), targets)
        else:
            self.readout_ = readout.fit(self.features_.map_log(rows), targets)
        return self

    def predict(self, X: ArrayLike) -> np.ndarray:
        """Return P_ff of every sample of a log, kPa."""
        check_is_fitted(self)
        rows = validate_data(self, X, reset=False, dtype=np.float64)
        return np.concatenate([self.readout_.predict(x) for x in self.features_.blocks(rows)])

    def learns_online(self) -> bool:
        """Return whether the fitted model can learn on: its readout is linear in few weights."""
        weights = getattr(self.readout_, "weights", None)
        return weights is not None and weights.size <= MOST_WEIGHTS

    def remember(self, X: ArrayLike, lengths: Sequence[int] | None = None) -> Self:
        """Keep of the training data what ``Online`` needs to go on from it.

        Sets ``information_``, the sum of the products of the readout's regressors, which must be
        linear in at most 512 weights. ``lengths`` are the samples of each of several recordings.
        """
        check_is_fitted(self)
        if not self.learns_online():
            raise ValueError(
                f"cannot learn on: that needs a readout of ours with at most {MOST_WEIGHTS} weights"
            )
        rows = validate_data(self, X, reset=False, dtype=np.float64)
        phi = self.readout_.regressors(self.features_.map_log(rows, lengths))
        self.information_ = phi.T @ phi
        return self

    def __sklearn_is_fitted__(self) -> bool:
        """Return whether ``fit`` has ended: one that failed leaves some attributes."""
        return hasattr(self, "readout_")

    def assembled(self, features: BaseEstimator, readout: BaseEstimator) -> Self:
        """Return a fitted copy of this model made of fitted parts, with a separate stream."""
        model = clone(self)
        model.n_features_in_ = features.n_features_in_
        model.features_, model.readout_ = deepcopy(features), readout
        return model

    def learned(self) -> dict[str, Any]:
        """Return what each attribute must be, see ``fprc.models.limits``."""
        parts: dict[str, Any] = {"features_": BaseEstimator, "readout_": BaseEstimator}
        if hasattr(self, "information_") and self.learns_online():
            parts["information_"] = Array((self.readout_.weights.size,) * 2)
        return parts

    def reset(self, x: ArrayLike | None = None) -> None:
        """Begin a new stream; ``x`` is the assumed input at all earlier times."""
        check_is_fitted(self)
        self.features_.reset(x)

    def step(self, x: ArrayLike) -> float:
        """Return P_ff(k), kPa, given the next sample of shape (n_inputs,).

        ValueError: the sample, which is then ignored, is not finite or beyond 1e9, or has the wrong
        number of inputs.
        """
        if not hasattr(self, "readout_"):
            check_is_fitted(self)
        row = self.features_.step(x)
        if hasattr(self.readout_, "output"):
            return self.readout_.output(row)
        return float(self.readout_.predict(row[None])[0])
