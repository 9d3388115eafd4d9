"""Several feature maps side by side."""

from collections.abc import Iterator, Sequence

import numpy as np
from sklearn.base import clone

from fprc.limits import Whole
from fprc.models.features import FeatureMap, Row
from fprc.models.learned import Learned, LearnedPart, features_of, rows_of

#: An unfitted map, and its columns of the input.
Part = tuple[FeatureMap, Sequence[int]]


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

    Raises
    ------
    ValueError
        At ``fit``: ``maps`` is not such a list or is empty, or a column does not exist.
    """

    def __init__(self, maps: Sequence[Part]):
        self.maps = maps

    def count_features(self) -> int | None:
        """Return the number of features of all maps; None if it is unknown for one of them."""
        counts = [features_of(part) for part in self.maps_]
        return None if None in counts else sum(filter(None, counts))

    def learned(self) -> Iterator[tuple[str, Learned]]:
        """Check the parameters, and yield the maps, see ``fprc.models.learned``."""
        self._check_columns()
        yield "maps_", [LearnedPart(part, len(columns)) for part, columns in self.maps]
        self._check_size()

    def prepare(self, X: np.ndarray) -> None:
        """See ``FeatureMap``."""
        self.maps_ = [clone(part).fit(X[:, columns]) for part, columns in self.maps]

    def _check_columns(self) -> None:
        try:
            pairs = [(part, list(columns)) for part, columns in self.maps]
        except (TypeError, ValueError):
            pairs = []
        if not pairs:
            raise ValueError(
                f"SideBySide: maps = {self.maps!r:.60}; must be a list of (map, columns)"
            )
        allowed = Whole(0, self.n_features_in_ - 1)
        for part, columns in pairs:
            if not isinstance(part, FeatureMap):
                raise ValueError(f"SideBySide: {part!r:.60} in maps; must be a FeatureMap")
            for column in columns:
                if not allowed.allows(column):
                    raise ValueError(f"{part!r:.60} needs column {column!r:.60}; must be {allowed}")

    def rows(self) -> list[Row] | None:
        """Return the features of all maps; None if one of them has others."""
        parts = [(rows_of(part), columns) for part, columns in self._parts()]
        if any(rows is None for rows, _ in parts):
            return None
        return [(columns[i], kind, number) for rows, columns in parts for i, kind, number in rows]

    def _parts(self) -> list[tuple[FeatureMap, list[int]]]:
        """Return each fitted map and the numbers of its columns."""
        each = [list(columns) for _, columns in self.maps]
        return list(zip(self.maps_, each, strict=True))

    def map_recording(self, X: np.ndarray) -> np.ndarray:
        """See ``FeatureMap``."""
        return np.hstack([part.map_log(X[:, columns]) for part, columns in self._parts()])

    def begin(self, x: np.ndarray) -> None:
        """See ``FeatureMap``."""
        self._each = [(part, np.array(columns)) for part, columns in self._parts()]
        for part, columns in self._each:
            part.reset(x[columns])

    def map_sample(self, x: np.ndarray) -> np.ndarray:
        """See ``FeatureMap``."""
        return np.concatenate([part.advance(x[columns]) for part, columns in self._each])
