"""Several feature maps side by side."""

from collections.abc import Iterator, Sequence
from numbers import Integral
from typing import Any, Self

import numpy as np
from sklearn.base import clone

from fprc.models.features import FeatureMap, Row
from fprc.models.learned import Learned, LearnedPart, features_of

#: Name, unfitted map, and its columns of the input; None is all of them.
Part = tuple[str, FeatureMap, Sequence[int] | None]


class SideBySide(FeatureMap):
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
        parameters = super().get_params(deep=False)
        if deep:
            for name, part in self._named_maps().items():
                parameters[name] = part
                parameters |= {f"{name}__{key}": value for key, value in part.get_params().items()}
        return parameters

    def set_params(self, **parameters: Any) -> Self:
        """Set ``maps``, a map by its name, or a parameter of a map by ``NAME__PARAMETER``."""
        if "maps" in parameters:
            self.maps = parameters.pop("maps")
        replaced = {name: parameters.pop(name) for name in self._named_maps() if name in parameters}
        if replaced:
            self.maps = [
                (name, replaced.get(name, part), columns) for name, part, columns in self.maps
            ]
        return super().set_params(**parameters)

    def _named_maps(self) -> dict[str, FeatureMap]:
        try:
            return {name: part for name, part, _ in self.maps if isinstance(part, FeatureMap)}
        except (TypeError, ValueError):
            return {}  # any value can be set; fit refuses a wrong one

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
            parts = [
                (str(name), part, [] if columns is None else list(columns))
                for name, part, columns in self.maps
            ]
        except (TypeError, ValueError) as error:
            raise ValueError(
                f"SideBySide: maps = {self.maps!r:.60}; must be a list of (name, map, columns)"
            ) from error
        names, last = [name for name, *_ in parts], self.n_features_in_ - 1
        problems = [] if names else ["there are no maps"]
        for name, part, columns in parts:
            if not isinstance(part, FeatureMap):
                problems.append(f"{name!r} is {type(part).__name__}; must be a FeatureMap")
            if names.count(name) > 1:
                problems.append(f"{name!r} is repeated")
            if "__" in name or name == "maps":
                problems.append(f"{name!r} must not contain __ or be 'maps'")
            problems += [
                f"{name!r} needs column {column}, but the columns are 0 to {last}"
                for column in columns
                if not (isinstance(column, Integral) and 0 <= column <= last)
            ]
        if problems:
            raise ValueError("\n".join(f"SideBySide: maps: {problem}" for problem in problems))

    def _columns(self) -> list[list[int]]:
        every = range(self.n_features_in_)
        return [list(every if columns is None else columns) for _, _, columns in self.maps]

    def rows(self) -> list[Row] | None:
        """Return the features of all maps; None if one of them has others."""
        parts = [(part.rows(), columns) for part, columns in self._parts()]
        if any(rows is None for rows, _ in parts):
            return None
        return [
            (columns[i], kind, number) for rows, columns in parts for i, kind, number in rows or ()
        ]

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
