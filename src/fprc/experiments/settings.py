"""Groups of settings that are passed on together."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Judgement:
    """How models are judged (Sec. III-D).

    Attributes
    ----------
    models : Mapping
        The section ``models`` of the configuration, or the part that the models read.
    folds : int
        Number of folds of the cross-validation.
    split : str
        Rows of a fold: ``shuffled`` or ``blocked``.
    seed : int
        Seed of folds and models.
    """

    models: Mapping[str, Any]
    folds: int
    split: str
    seed: int


@dataclass(frozen=True)
class RigSettings:
    """Settings that simulate the hysteresis experiments (Sec. II-B).

    Attributes
    ----------
    rig, control : Mapping
        Sections of the configuration.
    signals : Mapping
        Pressure signal of each experiment.
    target : str
        P_exp that the models learn: ``command`` or ``measured``.
    """

    rig: Mapping[str, Any]
    control: Mapping[str, Any]
    signals: Mapping[str, Any]
    target: str
