"""A model made of any feature map and any readout."""

from dataclasses import dataclass
from typing import Any

from sklearn.base import BaseEstimator, clone

from fprc.models.features import FeatureMap
from fprc.models.limits import SEED, check_limits
from fprc.models.sequence import SequenceModel


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
        """Return the unfitted map."""
        if not isinstance(self.features, FeatureMap):
            raise _not(self.features, "features", "a FeatureMap")
        return self._seeded(self.features)

    def make_readout(self) -> BaseEstimator:
        """Return the unfitted readout."""
        if isinstance(self.readout, type) or not hasattr(self.readout, "predict"):
            raise _not(self.readout, "readout", "a regressor")
        return self._seeded(self.readout)

    def _seeded(self, part: BaseEstimator) -> BaseEstimator:
        part = clone(part)
        check_limits(self, {"random_state": SEED})
        if self.random_state is not None:
            keys = [key for key in part.get_params() if key.split("__")[-1] == "random_state"]
            part.set_params(**dict.fromkeys(keys, self.random_state))
        return part


def _not(value: Any, name: str, wanted: str) -> ValueError:
    return ValueError(f"FeatureModel: {name} = {value!r:.60}; must be {wanted}")
