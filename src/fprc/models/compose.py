"""Models made of parts: any feature maps, also of another library, with any readout."""

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

import numpy as np
from sklearn.base import BaseEstimator, clone

from fprc.limits import Whole
from fprc.models.features import FeatureMap, Row, rows_of
from fprc.models.limits import check_limits
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
        scikit-learn. ``step`` takes microseconds with the readouts of this package, but 0.1 to
        10 ms with others, whose ``predict`` it calls with one row.
    random_state : int or None, default=None
        Replaces every ``random_state`` in ``features`` and ``readout``, but not those of the maps
        in a SideBySide; None leaves them.

    Attributes
    ----------
    features_, readout_ : estimator
        Fitted map and readout.
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
        if self.random_state is not None:
            keys = [key for key in part.get_params() if key.split("__")[-1] == "random_state"]
            part.set_params(**dict.fromkeys(keys, self.random_state))
        return part


@dataclass(eq=False, repr=False)
class SideBySide(FeatureMap):
    """Features of several maps, each of chosen columns, in one row.

    Like scikit-learn's ColumnTransformer, but the maps also run sample by sample.

    Parameters
    ----------
    maps : sequence of (FeatureMap, sequence of int)
        Each map, and the numbers of the columns of ``X`` that it gets, counted from 0. Maps may
        share columns.

    Attributes
    ----------
    maps_ : list of FeatureMap
        The fitted maps.
    """

    maps: Sequence[Part]

    def count_features(self, columns: int) -> int:
        allowed = Whole(0, columns - 1)
        for part, chosen in self.maps:
            right = len(chosen) and all(map(allowed.allows, chosen))
            if not isinstance(part, FeatureMap) or not right:
                raise ValueError(
                    f"SideBySide: {(part, chosen)!r:.60}: must be a FeatureMap and its columns, "
                    f"each {allowed}"
                )
            check_limits(part)
        return sum(part.count_features(len(chosen)) for part, chosen in self.maps)

    def learned(self) -> dict[str, Any]:
        return {"maps_": list}

    def prepare(self, X: np.ndarray) -> None:
        self.maps_ = [clone(part).fit(X[:, columns]) for part, columns in self.maps]

    def _parts(self) -> list[tuple[FeatureMap, np.ndarray]]:
        """Return each fitted map and the numbers of its columns."""
        each = [np.array(columns) for _, columns in self.maps]
        return list(zip(self.maps_, each, strict=True))

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
        Steps with the first sample as constant input, in which its state settles before a log
        begins.
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
