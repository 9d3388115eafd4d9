"""Feedforward hysteresis compensation models, as scikit-learn estimators."""

from fprc.models.compose import NVAR, FeatureModel, NodeFeatures, SideBySide
from fprc.models.esn import ESN, EchoStates
from fprc.models.features import FeatureMap, LowpassBank, PlayOperators, TapFeatures
from fprc.models.fprc import FPRC, FuzzyLinear, TakagiSugenoReadout
from fprc.models.online import Learning, Online
from fprc.models.ridge import RidgeReadout
from fprc.models.sequence import SequenceModel
from fprc.models.storage import load_model, save_model

__all__ = [
    "ESN", "FPRC", "NVAR", "EchoStates", "FeatureMap", "FeatureModel", "FuzzyLinear", "Learning",
    "LowpassBank", "NodeFeatures", "Online", "PlayOperators", "RidgeReadout", "SequenceModel",
    "SideBySide", "TakagiSugenoReadout", "TapFeatures", "load_model", "save_model",
]  # fmt: skip
