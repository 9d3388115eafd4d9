"""Fuzzy pneumatic reservoir computing, its readout, and the fuzzy model without a reservoir."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.distance import cdist
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from fprc.limits import LARGEST, MODEL, Limit
from fprc.models.fcm import fuzzy_c_means
from fprc.models.features import TapFeatures
from fprc.models.kernels import blend
from fprc.models.limits import Array, check_limits, training_data
from fprc.models.ridge import solve_ridge, with_bias
from fprc.models.sequence import SequenceModel


@dataclass(eq=False, repr=False)
class TakagiSugenoReadout(RegressorMixin, BaseEstimator):
    """Local linear models blended by Gaussian memberships.

    P_ff(k) = beta_bar(k) W_out [1, x(k)]        (12, with the leading 1)

    The second form of Eq. (12) lacks the 1; its first form and Eq. (7) have it. Paper, Sec. III-B,
    Eqs. (7)-(12).

    Parameters
    ----------
    n_c : int, default=8
        Fuzzy rules, >= 1.
    sigma : float, default=2.0
        Gaussian membership scaling, in the unit of the features.
    alpha : float, default=1e-3
        Ridge parameter of every rule, >= 0.
    random_state : int or None, default=None
        Start of the clustering.
    restarts : int, default=1
        Starts of the clustering, >= 1; the one with the lowest objective is kept.

    Attributes
    ----------
    centers_ : ndarray of shape (n_c, n_features)
        Cluster centres c_i.
    W_out_ : ndarray of shape (n_c, 1 + n_features)
        Weights of each rule, bias first.
    passes_ : float
        Iterations of the clustering; those on a part of the rows count in proportion.
    """

    n_c: int = MODEL["n_c"].default
    sigma: float = MODEL["sigma"].default
    alpha: float = MODEL["alpha"].default
    random_state: int | None = None
    restarts: int = MODEL["restarts"].default

    def learned(self) -> dict[str, Array | Limit]:
        # as far as samples go: C computes with distances from the centres
        centers = Array((self.n_c, self.n_features_in_), Limit(-LARGEST, LARGEST))
        weights = Array((self.n_c, 1 + self.n_features_in_))
        return {"centers_": centers, "W_out_": weights, "passes_": Limit(0, LARGEST)}

    def fit(self, X: ArrayLike, y: ArrayLike, *, init: np.ndarray | None = None) -> Self:
        """Cluster the rows, then fit each rule weighted by u_i^2 (Eq. 8).

        The clustering begins at the centres ``init``, by default at random samples.
        """
        check_limits(self)
        rows, targets = training_data(self, X, y)
        clusters = fuzzy_c_means(
            rows, self.n_c, random_state=self.random_state, restarts=self.restarts, init=init
        )
        self.centers_, self.W_out_ = clusters.centers, np.empty((self.n_c, 1 + rows.shape[1]))
        self.passes_ = clusters.passes
        extended = with_bias(rows)
        for i, u in enumerate(clusters.memberships.T):
            weighted = extended * (u**2)[:, None]
            self.W_out_[i] = solve_ridge(weighted.T @ extended, weighted.T @ targets, self.alpha)
        return self

    def predict(self, X: ArrayLike) -> np.ndarray:
        """Return the blended output of each row."""
        check_is_fitted(self)
        rows = validate_data(self, X, reset=False, dtype=np.float64)
        rules = self.W_out_[:, 1:] @ rows.T
        rules += self.W_out_[:, :1]
        rules *= gaussian_memberships(rows, self.centers_, self.sigma).T
        return rules.sum(axis=0)

    def regressors(self, rows: np.ndarray) -> np.ndarray:
        """Return what multiplies the weights ``W_out_``, rule by rule: beta_bar x [1, x]."""
        beta = gaussian_memberships(rows, self.centers_, self.sigma)
        return (beta[:, :, None] * with_bias(rows)[:, None, :]).reshape(len(rows), -1)

    @property
    def weights(self) -> np.ndarray:
        """All weights in a row, in the order of ``regressors``; a view, which may be written to."""
        return self.W_out_.reshape(-1)

    def output(self, x: np.ndarray) -> float:
        """Return the output of one row of features, without checks."""
        return blend(x, self.centers_, self.W_out_, float(self.sigma))


def gaussian_memberships(X: np.ndarray, centers: np.ndarray, sigma: float) -> np.ndarray:
    """Normalised memberships beta_bar of each row (Eqs. 10, 11).

    beta_i = exp(-||x - c_i||^2 / (2 sigma^2)), divided by the sum over i. The largest exponent is
    subtracted first: the result is the same, but a sample far from every centre is not 0 / 0.
    """
    # one row per cluster, and in place: NumPy is slow with short rows and new arrays
    beta = cdist(centers, X, "sqeuclidean")
    beta /= -2.0 * sigma**2
    beta -= beta.max(axis=0)
    np.exp(beta, out=beta)
    beta /= beta.sum(axis=0)
    return beta.T


@dataclass(eq=False, repr=False)
class FPRC(SequenceModel):
    """Takagi-Sugeno fuzzy readout over a pneumatic reservoir (Sec. III-B, Eqs. 6-12).

    x(k) = [theta(k), ..., theta(k-n_y+1), P~_o(k), ..., P~_o(k-n_u+1)]
    P_ff(k) = beta_bar(k) W_out [1, x(k)]        (12, with the leading 1)

    ``X`` has two columns, theta_d in deg and P_o in kPa; further columns are further readouts of
    the reservoir. Its rows are samples in time: see ``SequenceModel`` for cross-validation.

    Parameters
    ----------
    epsilon : float, default=0.01
        Filter factor of the readouts, in [1e-9, 1].
    n_c : int, default=8
        Fuzzy rules, >= 1.
    n_u : int, default=3
        Taps of the filtered readouts.
    n_y : int, default=5
        Taps of theta_d.
    sigma : float, default=2.0
        Gaussian membership scaling, in the unit of the features.
    alpha : float, default=1e-3
        Ridge parameter of every rule, >= 0.
    random_state : int or None, default=None
        Start of the clustering.
    restarts : int, default=1
        Starts of the clustering, >= 1; the one with the lowest objective is kept.
    """

    epsilon: float = MODEL["epsilon"].default
    n_c: int = MODEL["n_c"].default
    n_u: int = MODEL["n_u"].default
    n_y: int = MODEL["n_y"].default
    sigma: float = MODEL["sigma"].default
    alpha: float = MODEL["alpha"].default
    random_state: int | None = None
    restarts: int = MODEL["restarts"].default

    def make_features(self) -> TapFeatures:
        return self._part(TapFeatures)

    def make_readout(self) -> TakagiSugenoReadout:
        return self._part(TakagiSugenoReadout)


@dataclass(eq=False, repr=False)
class FuzzyLinear(SequenceModel):
    """Takagi-Sugeno fuzzy model of theta_d alone, the paper's comparison (Sec. III-D).

    x(k) = [theta(k), ..., theta(k-n_y+1)]
    P_ff(k) = beta_bar(k) W_out [1, x(k)]

    The paper replaces [1, x] by [1, theta] in Eqs. (7) and (12), but does not say whether the
    clusters still use P_o. Here they do not, so that the model needs no reservoir. ``X`` has one
    column; of a second, P_o too, it takes taps as of another reference, and is not the paper's
    model any more. The rows of ``X`` are samples in time, see ``SequenceModel``.

    Parameters
    ----------
    n_c : int, default=8
        Fuzzy rules, >= 1.
    n_y : int, default=5
        Taps of theta_d.
    sigma : float, default=2.0
        Gaussian membership scaling, in deg.
    alpha : float, default=1e-3
        Ridge parameter of every rule, >= 0.
    random_state : int or None, default=None
        Start of the clustering.
    restarts : int, default=1
        Starts of the clustering, >= 1; the one with the lowest objective is kept.
    """

    n_c: int = MODEL["n_c"].default
    n_y: int = MODEL["n_y"].default
    sigma: float = MODEL["sigma"].default
    alpha: float = MODEL["alpha"].default
    random_state: int | None = None
    restarts: int = MODEL["restarts"].default

    def make_features(self) -> TapFeatures:
        return self._part(TapFeatures, n_references=None, n_u=1)

    def make_readout(self) -> TakagiSugenoReadout:
        return self._part(TakagiSugenoReadout)
