"""Groups of settings that functions take together."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Judgement:
    """How models are judged (Sec. III-D)."""

    models: Mapping[str, Any]  #: section ``models`` of the configuration, or the part that is read
    folds: int  #: number of folds of the cross-validation
    split: str  #: rows of a fold: ``shuffled`` or ``blocked``
    seed: int  #: seed of folds and models


@dataclass(frozen=True)
class RigSettings:
    """Settings for the simulation of the hysteresis experiments (Sec. II-B)."""

    rig: Mapping[str, Any]  #: section of the configuration, as is ``control``
    control: Mapping[str, Any]
    signals: Mapping[str, Any]  #: pressure signal of each experiment
    target: str  #: P_exp that the models learn: ``command`` or ``measured``
