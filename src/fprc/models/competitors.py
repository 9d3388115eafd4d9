"""The models that compete beyond the paper, built from plain settings."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from sklearn.base import BaseEstimator
from sklearn.compose import TransformedTargetRegressor
from sklearn.ensemble import HistGradientBoostingRegressor
from sklearn.neural_network import MLPRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from fprc.competitors import competitor
from fprc.errors import ConfigError
from fprc.models.esn import ESN
from fprc.models.feature_model import FeatureModel
from fprc.models.features import TapFeatures
from fprc.models.fprc import FPRC, FuzzyLinear
from fprc.models.lowpass_bank import LowpassBank
from fprc.models.nvar import NVAR
from fprc.models.plays import PlayOperators
from fprc.models.ridge_readout import RidgeReadout
from fprc.models.sequence import SequenceModel
from fprc.models.side_by_side import SideBySide
from fprc.models.takagi_sugeno import TakagiSugenoReadout


def build_competitor(name: str, settings: Mapping[str, Any], seed: int) -> SequenceModel:
    """Return the unfitted competitor of that name.

    Parameters
    ----------
    name : str
        Key of ``fprc.competitors.COMPETITORS``.
    settings : Mapping
        All its settings, as ``fprc.competitors.default_settings`` returns them.
    seed : int
        Seed of everything random in it.

    Raises
    ------
    ConfigError
        There is no competitor of that name, or it has other settings.
    """
    competitor(name)
    try:
        model = _BUILDERS[name](**settings)
    except TypeError as error:
        raise ConfigError(f"competitor {name}: settings {dict(settings)}: {error}") from error
    return model.set_params(random_state=seed)


def _ridge_p_o(n_y: int, n_u: int, epsilon: float, alpha: float) -> FeatureModel:
    return FeatureModel(TapFeatures(n_y=n_y, n_u=n_u, epsilon=epsilon), RidgeReadout(alpha))


def _bank_p_o(n_y: int, epsilons: Sequence[float], alpha: float) -> FeatureModel:
    return FeatureModel(_bank(n_y, epsilons, column=1), RidgeReadout(alpha))


def _on_bank(n_y: int, epsilons: Sequence[float], **readout: Any) -> FeatureModel:
    return FeatureModel(_bank(n_y, epsilons), _readout(**readout))


def _on_plays(n_y: int, epsilons: Sequence[float], n_plays: int, **readout: Any) -> FeatureModel:
    bank = _bank(n_y, epsilons)
    return FeatureModel(
        SideBySide([*bank.maps, ("plays", PlayOperators(n_plays), [0])]), _readout(**readout)
    )


def _nvar(n_taps: int, spacing: int, degree: int, alpha: float) -> FeatureModel:
    return FeatureModel(NVAR(n_taps, spacing, degree), RidgeReadout(alpha))


def _trees(n_y: int, epsilons: Sequence[float], **settings: Any) -> FeatureModel:
    regressor = HistGradientBoostingRegressor(early_stopping=False, **settings)
    return FeatureModel(_bank(n_y, epsilons), regressor)


def _mlp(
    n_y: int, epsilons: Sequence[float], hidden: Sequence[int], tolerance: float
) -> FeatureModel:
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


_BUILDERS: Mapping[str, Callable[..., SequenceModel]] = {
    "esn": ESN,
    "fprc": FPRC,
    "fuzzy_linear": FuzzyLinear,
    "fprc_lowpass": FPRC,
    "ridge_p_o": _ridge_p_o,
    "bank_p_o": _bank_p_o,
    "bank": _on_bank,
    "bank_fuzzy": _on_bank,
    "plays": _on_plays,
    "plays_fuzzy": _on_plays,
    "nvar": _nvar,
    "trees": _trees,
    "mlp": _mlp,
}
