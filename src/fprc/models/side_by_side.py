"""Several feature maps side by side."""

from collections.abc import Iterator, Sequence
from typing import Any, Self

import numpy as np
from sklearn.base import clone
from sklearn.utils.metaestimators import _BaseComposition

from fprc.models.features import FeatureMap, Row
from fprc.models.learned import Learned, LearnedPart, features_of, rows_of
from fprc.models.limits import Whole

#: Name, unfitted map, and its columns of the input; None is all of them.
Part = tuple[str, FeatureMap, Sequence[int] | None]


class SideBySide(FeatureMap, _BaseComposition):
    """Features of several maps, each of chosen columns, in one row.

    Like scikit-learn's ColumnTransformer, but the maps also run sample by sample. Parameters of
    the maps are set as ``NAME__PARAMETER``, and ``NAME`` replaces a map.

    Parameters
    ----------
    maps : sequence of (str, FeatureMap, sequence of int or None)
        Name of each map, the map, and the numbers of the columns of ``X`` that it gets, counted
        from 0; None is all columns. Maps may share columns.

    Attributes
    ----------
    maps_ : list of FeatureMap
        The fitted maps.

    Raises
    ------
    ValueError
        At ``fit``: ``maps`` is not such a list or is empty, a name is repeated or contains
        ``__``, or a column does not exist.
    """

    def __init__(self, maps: Sequence[Part]):
        self.maps = maps

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """Return the parameters; with ``deep`` also the maps and their parameters."""
        return self._get_params("_named", deep=deep)

    def set_params(self, **parameters: Any) -> Self:
        """Set ``maps``, a map by its name, or a parameter of a map by ``NAME__PARAMETER``."""
        return self._set_params("_named", **parameters)

    @property
    def _named(self) -> Any:
        try:
            return [(name, part) for name, part, _ in self.maps]
        except (TypeError, ValueError):
            return []  # any value can be set; fit refuses a wrong one

    @_named.setter
    def _named(self, named: Sequence[tuple[str, FeatureMap]]) -> None:
        pairs = zip(named, self.maps, strict=True)
        self.maps = [(name, part, columns) for (name, part), (_, _, columns) in pairs]

    def count_features(self) -> int | None:
        """Return the number of features of all maps; None if it is unknown for one of them."""
        counts = [features_of(part) for part in self.maps_]
        return None if None in counts else sum(filter(None, counts))

    def learned(self) -> Iterator[tuple[str, Learned]]:
        """Check the parameters, and yield the maps, see ``fprc.models.learned``."""
        self._check_columns()
        pairs = zip(self.maps, self._columns(), strict=True)
        yield "maps_", [LearnedPart(part, len(columns)) for (_, part, _), columns in pairs]
        self._check_size()

    def _prepare(self, X: np.ndarray) -> None:
        self.maps_ = [
            clone(part).fit(X[:, columns])
            for (_, part, _), columns in zip(self.maps, self._columns(), strict=True)
        ]

    def _check_columns(self) -> None:
        try:
            each = list(zip(self._named, self._columns(), strict=True))
        except (TypeError, ValueError):
            each = []
        if not each:
            raise ValueError(
                f"SideBySide: maps = {self.maps!r:.60}; must be a list of (name, map, columns)"
            )
        allowed = Whole(0, self.n_features_in_ - 1)
        self._validate_names([str(name) for (name, _), _ in each])
        for (name, part), columns in each:
            if not isinstance(part, FeatureMap):
                raise ValueError(f"{name!r} is {type(part).__name__}; must be a FeatureMap")
            for column in columns:
                if not allowed.allows(column):
                    raise ValueError(f"{name!r} needs column {column!r:.60}; must be {allowed}")

    def _columns(self) -> list[list[int]]:
        every = range(self.n_features_in_)
        return [list(every if columns is None else columns) for _, _, columns in self.maps]

    def rows(self) -> list[Row] | None:
        """Return the features of all maps; None if one of them has others."""
        parts = [(rows_of(part), columns) for part, columns in self._parts()]
        if any(rows is None for rows, _ in parts):
            return None
        return [(columns[i], kind, number) for rows, columns in parts for i, kind, number in rows]

    def _parts(self) -> list[tuple[FeatureMap, list[int]]]:
        """Return each fitted map and the numbers of its columns."""
        return list(zip(self.maps_, self._columns(), strict=True))

    def _transform(self, X: np.ndarray) -> np.ndarray:
        return np.hstack([part.transform(X[:, columns]) for part, columns in self._parts()])

    def _start(self, x: np.ndarray) -> None:
        self._each = [(part, np.array(columns)) for part, columns in self._parts()]
        for part, columns in self._each:
            part.reset(x[columns])

    def _step(self, x: np.ndarray) -> np.ndarray:
        return np.concatenate([part.advance(x[columns]) for part, columns in self._each])
