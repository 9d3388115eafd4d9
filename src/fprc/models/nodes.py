"""Reservoirs of another library as features."""

from copy import deepcopy
from dataclasses import dataclass
from typing import Any

import numpy as np

from fprc.models.features import FeatureMap


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

    def map_recording(self, X: np.ndarray) -> np.ndarray:
        return np.asarray(self._settled(X[0]).run(X))

    def begin(self, x: np.ndarray) -> None:
        self._stream = self._settled(x)

    def map_sample(self, x: np.ndarray) -> np.ndarray:
        return np.asarray(self._stream.run(x[None]))[0]

    def _settled(self, x: np.ndarray) -> Any:
        node = deepcopy(self.node_)
        if self.washout:
            node.run(np.repeat(x[None], self.washout, axis=0))
        return node
