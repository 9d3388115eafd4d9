"""Groups of settings that are passed on together."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fprc.evaluation import split_rows
from fprc.evaluation.folds import Fold


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
    purge_s : float
        Time on each side of a contiguous block that does not train.
    """

    models: Mapping[str, Any]
    folds: int
    split: str
    seed: int
    purge_s: float = 2.0

    def split_rows(self, time_s: np.ndarray) -> list[Fold]:
        """Return (training rows, validation rows) of each fold of a log."""
        purge = round(self.purge_s * (len(time_s) - 1) / float(time_s[-1] - time_s[0]))
        return split_rows(len(time_s), self.folds, self.split, self.seed, purge)


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
