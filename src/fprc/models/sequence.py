"""A model with memory: a sequential feature map and a row-wise readout."""

from abc import abstractmethod
from copy import deepcopy
from typing import Self

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator, RegressorMixin, clone
from sklearn.utils.validation import check_is_fitted, validate_data


class SequenceModel(RegressorMixin, BaseEstimator):
    """Base of the feedforward models: rows of ``X`` are samples in time.

    The features depend on the history of the log, the readout on single rows.
    Cross-validation therefore computes the features once and fits one readout
    per fold; ``assembled`` joins the two into a model.
    """

    @abstractmethod
    def make_features(self) -> BaseEstimator:
        """Return the unfitted feature map."""

    @abstractmethod
    def make_readout(self) -> BaseEstimator:
        """Return the unfitted readout."""

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Train on one log.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_inputs)
            Samples in the order of time.
        y : array-like of shape (n_samples,)
            P_exp, kPa.

        Raises
        ------
        ValueError
            ``X`` or ``y`` is not finite, or the log is shorter than the taps.
        """
        X, y = validate_data(self, X, y, y_numeric=True, dtype=np.float64)
        self.features_ = self.make_features().fit(X)
        self.readout_ = self.make_readout().fit(self.features_.transform(X), y)
        return self

    def predict(self, X: ArrayLike) -> np.ndarray:
        """Return P_ff for a whole log, kPa."""
        check_is_fitted(self)
        X = validate_data(self, X, reset=False, dtype=np.float64)
        return self.readout_.predict(self.features_.transform(X))

    def assembled(self, features: BaseEstimator, readout: BaseEstimator) -> Self:
        """Return a fitted copy of this model made of fitted parts, with a stream of its own."""
        model = clone(self)
        model.n_features_in_ = features.n_features_in_
        model.features_ = deepcopy(features)
        model.readout_ = readout
        return model

    def reset(self, x: ArrayLike | None = None) -> None:
        """Begin a new stream; ``x`` is the assumed input at all earlier times.

        Raises
        ------
        NotFittedError
            ``fit`` was not called.
        """
        check_is_fitted(self)
        self.features_.reset(x)

    def step(self, x: ArrayLike) -> float:
        """Return P_ff(k), kPa, given the next sample of shape (n_inputs,).

        Raises
        ------
        NotFittedError
            ``fit`` was not called.
        ValueError
            The sample is not finite or has another number of inputs.
        """
        try:
            features, readout = self.features_, self.readout_
        except AttributeError:
            check_is_fitted(self)
            raise
        return readout.output(features.advance(x))
