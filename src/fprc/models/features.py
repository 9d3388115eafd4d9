"""Base of the sequential feature maps, and the maps of taps, of low-passes and of plays.

Each maps a log to a matrix of features in one go (``transform``) or sample by
sample (``step``), with the same result. Before the log begins, the signals are
assumed to equal its first sample.
"""

from collections.abc import Iterator, Sequence
from copy import copy, deepcopy
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator, ClassNamePrefixFeaturesOutMixin, TransformerMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from fprc.limits import LARGEST, MODEL, Limit
from fprc.models.kernels import LOWPASS, PLAY, TAP, advance, advance_log
from fprc.models.limits import Array, check_limits, is_built_in

#: A feature: its column, its kind, and its number, see ``kernels.advance``.
Row = tuple[int, int, float]

#: Samples of a block of features: with 800 states it takes 52 MB.
BLOCK = 8_000


def rows_of(features: Any) -> list[Row]:
    """Return the rows of a fitted map; none if its class is from outside and may change them."""
    return features.rows() if is_built_in(features) else []


def table(rows: Sequence[Row]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return columns, kinds and numbers of some features."""
    columns, kinds, numbers = zip(*rows, strict=True)
    return np.array(columns), np.array(kinds), np.array(numbers, dtype=float)


class FeatureMap(ClassNamePrefixFeaturesOutMixin, TransformerMixin, BaseEstimator):
    """Base of the sequential feature maps: rows are samples in time, see ``SequenceModel``.

    A map of your own has ``begin`` and ``map_sample``; also ``prepare``, if it learns or draws
    something, and ``map_recording``, if it maps a whole recording faster than sample by sample.
    """

    _streaming = False

    def fit(self, X: ArrayLike, y: ArrayLike | None = None) -> Self:
        """Store the number of columns, and learn or draw what the map needs."""
        samples = self._samples(X, first=True)
        check_limits(self)
        self.prepare(samples)
        self.reset()
        return self

    def map_log(self, X: ArrayLike, lengths: Sequence[int] | None = None) -> np.ndarray:
        """Return the features of every sample of a log, of shape (n_samples, n_features).

        ``lengths`` are the samples of each recording, if the log holds several: features restart at
        each. None may be shorter than the taps.
        """
        rows = list(self.blocks(X, lengths, most=None))
        return rows[0] if len(rows) == 1 else np.concatenate(rows)

    transform = map_log  # which returns the container that ``set_output`` asks for

    def blocks(
        self, X: ArrayLike, lengths: Sequence[int] | None = None, most: int | None = BLOCK
    ) -> Iterator[np.ndarray]:
        """Yield what ``map_log`` returns, in blocks of which each may overwrite the one before.

        A block has ``most`` samples, or is a recording as the map likes; None: a recording.
        """
        check_is_fitted(self)
        samples = self._samples(X, first=False)
        lengths = [len(samples)] if lengths is None else lengths
        if min(lengths, default=0) < 1 or sum(lengths) != len(samples):
            raise ValueError(
                f"lengths = {list(lengths)!r:.60}; must be above 0, in sum {len(samples)} samples"
            )
        for part in np.split(samples, np.cumsum(lengths)[:-1]):
            yield from self._blocks(part, most or len(part))

    def _blocks(self, X: np.ndarray, most: int) -> Iterator[np.ndarray]:
        yield self.map_recording(X)

    def _samples(self, X: ArrayLike, *, first: bool) -> np.ndarray:
        samples = validate_data(self, X, reset=first, dtype=np.float64)
        faults = np.argwhere(np.abs(samples) > LARGEST)  # which ``step`` would refuse
        if len(faults):
            k, j = faults[0]
            raise ValueError(
                f"X: column {j}, sample {k} is {samples[k, j]:g}: remove what is beyond {LARGEST:g}"
            )
        return samples

    def reset(self, x: ArrayLike | None = None) -> None:
        """Begin a new stream; ``x`` is the assumed input at all earlier times."""
        if x is not None:
            self.begin(self._checked(x))
        self._streaming = x is not None

    def step(self, x: ArrayLike) -> np.ndarray:
        """Return the features of the next sample ``x`` of shape (n_inputs,).

        A sample that is not finite or beyond 1e9, or has another number of inputs, is ignored and
        a ValueError.
        """
        x = self._checked(x)
        if not self._streaming:
            self.reset(x)
        return np.array(self.map_sample(x))

    def _checked(self, x: ArrayLike) -> np.ndarray:
        # a copy: numba would compile again for a view or a read-only array
        x = np.array(x, dtype=np.float64)
        if not hasattr(self, "n_features_in_"):
            check_is_fitted(self)
        listed = x.tolist()
        # NaN is not within the limits
        if x.shape != (self.n_features_in_,) or not all(-LARGEST <= v <= LARGEST for v in listed):
            raise ValueError(
                f"sample {listed}: must be {self.n_features_in_} numbers within {LARGEST:g} either "
                "way; the sample is ignored and the stream continues"
            )
        return x

    @property
    def _n_features_out(self) -> int:
        return deepcopy(self).step(np.zeros(self.n_features_in_)).size

    def count_features(self, columns: int) -> int:
        """Return how many features so many columns have, 0 if only the first sample tells it.

        ValueError: the parameters do not suit the number of columns.
        """
        return 0

    def rows(self) -> list[Row]:
        """Return all features of a fitted map; none if they are not taps, low-passes and plays."""
        return []

    def prepare(self, X: np.ndarray) -> None:
        """Learn or draw what the map needs, from the training log, of shape (n_samples, n_inputs).

        What it keeps for ever goes into attributes whose names end in ``_``: finite numbers, arrays
        of them or text, which files of models hold.
        """

    def map_recording(self, X: np.ndarray) -> np.ndarray:
        """Return the features of a recording, of shape (n_samples, n_features).

        By default sample by sample. The stream of ``begin`` must go on as if nothing had been.
        """
        if self.rows():
            # a copy: numba would compile again for another layout or a read-only array
            return advance_log(np.array(X, order="C"), *table(self.rows()))
        other = copy(self)
        other.begin(X[0])
        return np.array([np.array(other.map_sample(x)) for x in X])

    def begin(self, x: np.ndarray) -> None:
        """Begin a stream, in new attributes; ``x`` is the assumed input at all earlier times."""
        self._table = table(self.rows())
        self._row = x[self._table[0]]

    def map_sample(self, x: np.ndarray) -> np.ndarray:
        """Return the features of the next sample, given its inputs; the caller only reads them."""
        advance(self._row, x, *self._table)
        return self._row


@dataclass(eq=False, repr=False)
class TapFeatures(FeatureMap):
    """Taps of references and of low-passed reservoir readouts.

    x(k) = [theta(k), ..., theta(k-n_y+1), P~(k), ..., P~(k-n_u+1)], with
    P~(k) = epsilon P(k) + (1 - epsilon) P~(k-1)      (6)

    Parameters
    ----------
    n_y : int, default=5
        Taps of every reference column, >= 1.
    n_references : int or None, default=1
        Leading columns that are references, the others are readouts; None takes all as references.
    n_u : int, default=3
        Taps of every readout column, >= 1.
    epsilon : float, default=0.01
        Filter factor of the readouts, in [1e-9, 1].
    """

    n_y: int = MODEL["n_y"].default
    n_references: int | None = 1
    n_u: int = MODEL["n_u"].default
    epsilon: float = MODEL["epsilon"].default

    def count_references(self) -> int:
        """Return the number of leading columns that are references."""
        return self.n_features_in_ if self.n_references is None else self.n_references

    def count_features(self, columns: int) -> int:
        references = columns if self.n_references is None else self.n_references
        if self.n_references is not None and columns <= references:
            raise ValueError(
                f"n_features={columns}, of which {references} are references, which leaves no "
                "readout; give one, or n_references=None (the model FuzzyLinear)"
            )
        return self.n_y * references + self.n_u * (columns - references)

    def rows(self) -> list[Row]:
        rows = list[Row]()
        for i in range(self.n_features_in_):
            newest, size = (i, LOWPASS, float(self.epsilon)), self.n_u
            if i < self.count_references():
                newest, size = (i, PLAY, 0.0), self.n_y
            rows += [newest] + [(i, TAP, 0.0)] * (size - 1)
        return rows

    def map_recording(self, X: np.ndarray) -> np.ndarray:
        if len(X) < (size := max(self.n_y, self.n_u)):
            raise ValueError(
                f"n_samples = {len(X)} is under {size}; use fewer taps or a longer log"
            )
        signals = np.array(X, order="C")
        for i in range(self.count_references(), X.shape[1]):
            # by pandas: other last digits would move those of every closed loop in the results
            signals[:, i] = pd.Series(X[:, i]).ewm(alpha=self.epsilon, adjust=False).mean()
        unfiltered = [(i, TAP if kind == TAP else PLAY, 0.0) for i, kind, _ in self.rows()]
        return advance_log(signals, *table(unfiltered))


@dataclass(eq=False, repr=False)
class LowpassBank(FeatureMap):
    """Every column, low-passed with several filter factors (Eq. 6, which has one).

    x~(k) = epsilon x(k) + (1 - epsilon) x~(k-1), from x~(-1) = x(0)

    Parameters
    ----------
    epsilons : sequence of float, default=(0.03, 0.01, 0.003)
        Filter factors, in [1e-9, 1]: about 1 over the time constant in samples. 1 is the column.
    """

    epsilons: Sequence[float] = (0.03, 0.01, 0.003)

    def count_features(self, columns: int) -> int:
        each = MODEL["epsilon"]
        if not 0 < len(self.epsilons) <= 1000 or not all(map(each.allows, self.epsilons)):
            raise ValueError(f"epsilons = {self.epsilons!r:.60}; must be 1 to 1000 times {each}")
        return columns * len(self.epsilons)

    def rows(self) -> list[Row]:
        columns = range(self.n_features_in_)
        return [(i, LOWPASS, float(epsilon)) for i in columns for epsilon in self.epsilons]


@dataclass(eq=False, repr=False)
class PlayOperators(FeatureMap):
    """Play operators of every column: backlash of several widths.

    p(k) = max(x(k) - r, min(x(k) + r, p(k-1))), from p(-1) = x(0)

    A play follows its input at the distance r; after a reversal it waits until the input has moved
    by 2 r. A ridge on plays is a Prandtl-Ishlinskii model, whose loops do not depend on the speed
    of the input. The half-widths r divide half the range of each column of the training log into
    n_plays + 1 equal parts; a play with half the range as r would not move. Kuhnen, European
    Journal of Control 9 (2003), 407-418.

    Parameters
    ----------
    n_plays : int, default=10
        Plays of every column, >= 1.

    Attributes
    ----------
    half_widths_ : ndarray of shape (n_inputs, n_plays)
        r of each play, ascending, in the unit of its column.
    """

    n_plays: int = 10

    def count_features(self, columns: int) -> int:
        return columns * self.n_plays

    def learned(self) -> dict[str, Any]:
        return {"half_widths_": Array((self.n_features_in_, self.n_plays), Limit(0, 1e30))}

    def prepare(self, X: np.ndarray) -> None:
        shares = np.arange(1, self.n_plays + 1) / (self.n_plays + 1)
        self.half_widths_ = np.outer(np.ptp(X, axis=0) / 2.0, shares)

    def rows(self) -> list[Row]:
        return [(i, PLAY, r) for i, widths in enumerate(self.half_widths_.tolist()) for r in widths]
