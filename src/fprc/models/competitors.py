"""The models that compete beyond the paper, built from plain settings; see ``fprc.registry``."""

from collections.abc import Sequence
from typing import Any

from sklearn.base import BaseEstimator
from sklearn.compose import TransformedTargetRegressor
from sklearn.ensemble import HistGradientBoostingRegressor
from sklearn.neural_network import MLPRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from fprc.models.feature_model import FeatureModel
from fprc.models.features import TapFeatures
from fprc.models.lowpass_bank import LowpassBank
from fprc.models.nvar import NVAR
from fprc.models.plays import PlayOperators
from fprc.models.ridge_readout import RidgeReadout
from fprc.models.side_by_side import SideBySide
from fprc.models.takagi_sugeno import TakagiSugenoReadout


def ridge_p_o(n_y: int, n_u: int, epsilon: float, alpha: float) -> FeatureModel:
    """Return a ridge on FPRC's features."""
    return FeatureModel(TapFeatures(n_y=n_y, n_u=n_u, epsilon=epsilon), RidgeReadout(alpha))


def bank_p_o(n_y: int, epsilons: Sequence[float], alpha: float) -> FeatureModel:
    """Return a ridge on taps of theta_d and low-passes of P_o."""
    return FeatureModel(_bank(n_y, epsilons, column=1), RidgeReadout(alpha))


def on_bank(n_y: int, epsilons: Sequence[float], **readout: Any) -> FeatureModel:
    """Return a ridge, or with rules a fuzzy readout, on taps and low-passes of theta_d."""
    return FeatureModel(_bank(n_y, epsilons), _readout(**readout))


def on_plays(n_y: int, epsilons: Sequence[float], n_plays: int, **readout: Any) -> FeatureModel:
    """Return a ridge, or with rules a fuzzy readout, on low-passes and plays of theta_d."""
    bank = _bank(n_y, epsilons)
    return FeatureModel(
        SideBySide([*bank.maps, ("plays", PlayOperators(n_plays), [0])]), _readout(**readout)
    )


def nvar(n_taps: int, spacing: int, degree: int, alpha: float) -> FeatureModel:
    """Return a ridge on products of delayed theta_d."""
    return FeatureModel(NVAR(n_taps, spacing, degree), RidgeReadout(alpha))


def trees(n_y: int, epsilons: Sequence[float], **settings: Any) -> FeatureModel:
    """Return boosted trees on taps and low-passes of theta_d."""
    regressor = HistGradientBoostingRegressor(early_stopping=False, **settings)
    return FeatureModel(_bank(n_y, epsilons), regressor)


def mlp(
    n_y: int, epsilons: Sequence[float], hidden: Sequence[int], tolerance: float
) -> FeatureModel:
    """Return a small neural network on taps and low-passes of theta_d."""
    network = MLPRegressor(
        hidden_layer_sizes=tuple(hidden),
        early_stopping=True,
        tol=tolerance,
        n_iter_no_change=5,
        max_iter=1000,
    )
    regressor = TransformedTargetRegressor(
        make_pipeline(StandardScaler(), network), transformer=StandardScaler()
    )
    return FeatureModel(_bank(n_y, epsilons), regressor)


def _bank(n_y: int, epsilons: Sequence[float], column: int = 0) -> SideBySide:
    """Return taps of the first column beside low-passes of ``column``."""
    return SideBySide(
        [
            ("taps", TapFeatures(n_y, n_references=None), [0]),
            ("lowpasses", LowpassBank(epsilons), [column]),
        ]
    )


def _readout(**settings: Any) -> BaseEstimator:
    """Return the fuzzy readout if the settings have rules, else the ridge."""
    return (TakagiSugenoReadout if "n_c" in settings else RidgeReadout)(**settings)
