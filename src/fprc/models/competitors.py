"""The models that compete beyond the paper, built from plain settings; see ``fprc.registry``."""

from collections.abc import Sequence
from typing import Any

from sklearn.compose import TransformedTargetRegressor
from sklearn.ensemble import HistGradientBoostingRegressor
from sklearn.neural_network import MLPRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from fprc.models.compose import NVAR, FeatureModel, Part, SideBySide
from fprc.models.esn import EchoStates
from fprc.models.features import LowpassBank, PlayOperators, TapFeatures
from fprc.models.fprc import TakagiSugenoReadout
from fprc.models.ridge import RidgeReadout


def on_taps(alpha: float, **taps: Any) -> FeatureModel:
    """Return a ridge on taps: of every column, as FPRC's, or with a degree on their products."""
    features = NVAR(**taps) if "degree" in taps else TapFeatures(**taps)
    return FeatureModel(features, RidgeReadout(alpha))


def on_bank(
    n_y: int,
    epsilons: Sequence[float],
    *,
    n_plays: int = 0,
    epsilons_p_o: Sequence[float] = (),
    **readout: Any,
) -> FeatureModel:
    """Return a ridge, or with rules a fuzzy readout, on taps and low-passes of theta_d.

    Further features are plays of theta_d, and low-passes of P_o, column 1.
    """
    maps = _bank(n_y, epsilons)
    if n_plays:
        maps.append((PlayOperators(n_plays), [0]))
    if epsilons_p_o:
        maps.append((LowpassBank(epsilons_p_o), [1]))
    regressor = TakagiSugenoReadout if "n_c" in readout else RidgeReadout
    return FeatureModel(SideBySide(maps), regressor(**readout))


def echo_p_o(
    alpha: float, epsilons_p_o: Sequence[float], random_state: int = 1, **network: Any
) -> FeatureModel:
    """Return a ridge on the states of an ESN of theta_d, column 0, and on low-passes of P_o."""
    echo = EchoStates(**network, random_state=random_state)
    maps = [(echo, [0]), (LowpassBank(epsilons_p_o), [1])]
    return FeatureModel(SideBySide(maps), RidgeReadout(alpha))


def trees(n_y: int, epsilons: Sequence[float], **settings: Any) -> FeatureModel:
    """Return boosted trees on taps and low-passes of theta_d."""
    regressor = HistGradientBoostingRegressor(early_stopping=False, **settings)
    return FeatureModel(SideBySide(_bank(n_y, epsilons)), regressor)


def mlp(n_y: int, epsilons: Sequence[float], **settings: Any) -> FeatureModel:
    """Return a small neural network on taps and low-passes of theta_d."""
    network = MLPRegressor(early_stopping=True, n_iter_no_change=5, max_iter=1000, **settings)
    scaled = make_pipeline(StandardScaler(), network)
    regressor = TransformedTargetRegressor(scaled, transformer=StandardScaler())
    return FeatureModel(SideBySide(_bank(n_y, epsilons)), regressor)


def _bank(n_y: int, epsilons: Sequence[float]) -> list[Part]:
    """Return taps of theta_d, column 0, beside its low-passes."""
    return [(TapFeatures(n_y, n_references=None), [0]), (LowpassBank(epsilons), [0])]
