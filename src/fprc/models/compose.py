"""Models made of parts: any feature maps, also of another library, with any readout; NVAR."""

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass
from itertools import combinations_with_replacement
from math import comb
from typing import Any

import numpy as np
from sklearn.base import BaseEstimator, clone

from fprc.limits import LARGEST, Limit, Whole
from fprc.models.features import FeatureMap, Row, rows_of
from fprc.models.limits import SMALLEST_SCALE, Array, check_limits
from fprc.models.sequence import SequenceModel

#: An unfitted map, and its columns of the input.
Part = tuple[FeatureMap, Sequence[int]]


@dataclass(eq=False, repr=False)
class FeatureModel(SequenceModel):
    """Any feature map with any readout.

    Parameters
    ----------
    features : FeatureMap
        Unfitted map, such as TapFeatures, LowpassBank or SideBySide of several.
    readout : estimator
        Unfitted regressor: RidgeReadout, TakagiSugenoReadout, or any regressor or pipeline of
        scikit-learn. ``step`` takes microseconds with ours, 0.1 to 10 ms with others.
    random_state : int or None, default=None
        Replaces every ``random_state`` in ``features`` and ``readout``, but not those of the maps
        in a SideBySide; None leaves them.
    """

    features: FeatureMap
    readout: BaseEstimator
    random_state: int | None = None

    def make_features(self) -> FeatureMap:
        return self._seeded(self.features)

    def make_readout(self) -> BaseEstimator:
        return self._seeded(self.readout)

    def _seeded(self, part: BaseEstimator) -> BaseEstimator:
        part = clone(part)
        for key in part.get_params():
            if key.split("__")[-1] == "random_state" and self.random_state is not None:
                part.set_params(**{key: self.random_state})
        return part


@dataclass(eq=False, repr=False)
class SideBySide(FeatureMap):
    """Features of several maps, each of chosen columns, in one row.

    Like scikit-learn's ColumnTransformer, but the maps also run sample by sample.

    Parameters
    ----------
    maps : sequence of (FeatureMap, sequence of int)
        Each map, and the numbers of its columns of ``X``, counted from 0; maps may share them.

    Attributes
    ----------
    maps_ : list of FeatureMap
        The fitted maps.
    """

    maps: Sequence[Part]

    def count_features(self, columns: int) -> int:
        allowed, count = Whole(0, columns - 1), 0
        for part, chosen in self.maps:
            right = len(chosen) and all(map(allowed.allows, chosen))
            if not isinstance(part, FeatureMap) or not right:
                raise ValueError(
                    f"SideBySide: {(part, chosen)!r:.60}: give a FeatureMap and columns, {allowed}"
                )
            check_limits(part)
            count += part.count_features(len(chosen))
        return count

    def learned(self) -> dict[str, Any]:
        return {"maps_": list}

    def prepare(self, X: np.ndarray) -> None:
        self.maps_ = [clone(part).fit(X[:, columns]) for part, columns in self.maps]

    def _parts(self) -> list[tuple[FeatureMap, np.ndarray]]:
        """Return each fitted map and the numbers of its columns."""
        return [(part, np.array(of)) for part, (_, of) in zip(self.maps_, self.maps, strict=True)]

    def rows(self) -> list[Row]:
        each = [(rows_of(part), columns) for part, columns in self._parts()]
        if not all(rows for rows, _ in each):
            return []
        return [(columns[i], kind, number) for rows, columns in each for i, kind, number in rows]

    def map_recording(self, X: np.ndarray) -> np.ndarray:
        return np.hstack([part.map_log(X[:, columns]) for part, columns in self._parts()])

    def begin(self, x: np.ndarray) -> None:
        self._each = self._parts()
        for part, columns in self._each:
            part.reset(x[columns])

    def map_sample(self, x: np.ndarray) -> np.ndarray:
        return np.concatenate([part.step(x[columns]) for part, columns in self._each])


@dataclass(eq=False, repr=False)
class NodeFeatures(FeatureMap):
    """States of a node or a model of ReservoirPy, or of anything with its ``run`` and ``reset``.

    The taps of the input, which an ESN's readout gets too, come from ``TapFeatures`` in a
    ``SideBySide``. A model with such features is not saved: files hold numbers and text only.

    Parameters
    ----------
    node : object
        Node before its first run; each ``fit`` takes a copy. Give it a seed.
    washout : int, default=100
        Steps with the first sample as constant input, in which the state settles.
    """

    node: Any
    washout: int = 100

    def prepare(self, X: np.ndarray) -> None:
        self.node_ = deepcopy(self.node)
        self.node_.run(X[:1])
        self.node_.reset()

    def begin(self, x: np.ndarray) -> None:
        self._stream = deepcopy(self.node_)
        for _ in range(self.washout):
            self.map_sample(x)

    def map_sample(self, x: np.ndarray) -> np.ndarray:
        return np.asarray(self._stream.run(x[None]))[0]


@dataclass(eq=False, repr=False)
class NVAR(FeatureMap):
    """Spaced taps of every column, and their products.

    z(k) = [x(k), x(k-s), ..., x(k-(n_taps-1) s)], of every column, standardised
    features(k) = [z(k), every product of ``degree`` elements of z(k)]

    Columns are standardised because a ridge with one alpha would penalise the taps of a signal of
    60 deg far more than its squares of 3,600. Gauthier, Bollt, Griffith and Barbosa, Nature
    Communications 12 (2021), 5564.

    Parameters
    ----------
    n_taps : int, default=5
        Taps of every column, >= 1.
    spacing : int, default=25
        Samples from one tap to the next, >= 1.
    degree : int, default=2
        Factors of each product, >= 2.

    Attributes
    ----------
    mean_, scale_ : ndarray of shape (n_inputs,)
        Mean and standard deviation of each column of the training log; the latter is 1 for a
        column that is constant but for rounding.
    """

    n_taps: int = 5
    spacing: int = 25
    degree: int = 2

    def count_features(self, columns: int) -> int:
        linear = columns * self.n_taps
        return linear + comb(linear + self.degree - 1, self.degree)

    def learned(self) -> dict[str, Any]:
        mean = Array((self.n_features_in_,), Limit(-2 * LARGEST, 2 * LARGEST))
        return {"mean_": mean, "scale_": Array(mean.shape, Limit(SMALLEST_SCALE, 1e30))}

    def prepare(self, X: np.ndarray) -> None:
        self.mean_, spread = X.mean(axis=0), X.std(axis=0)
        rounding = SMALLEST_SCALE * np.maximum(np.abs(X).max(axis=0), 1.0)
        self.scale_ = np.where(spread >= rounding, spread, 1.0)

    def begin(self, x: np.ndarray) -> None:
        linear, span = range(len(x) * self.n_taps), (self.n_taps - 1) * self.spacing + 1
        self._products = np.array(list(combinations_with_replacement(linear, self.degree)))
        self._history = np.repeat(((x - self.mean_) / self.scale_)[:, None], span, axis=1)

    def map_sample(self, x: np.ndarray) -> np.ndarray:
        self._history[:, 1:] = self._history[:, :-1]
        self._history[:, 0] = (x - self.mean_) / self.scale_
        linear = self._history[:, :: self.spacing].ravel()
        return np.concatenate([linear, linear[self._products].prod(axis=1)])
