"""Groups of settings that functions take together."""

from typing import TYPE_CHECKING, Any, Literal

from fprc.config.section import Section
from fprc.config.settings import Control, Signal
from fprc.experiments.data import Data

if TYPE_CHECKING:
    from fprc.evaluation.folds import Fold


class CrossValidation(Section):
    """How models are cross-validated (Sec. III-D)."""

    models: dict[str, Any]  #: section ``models`` of the configuration, or the part that is read
    folds: int  #: number of folds of the cross-validation
    split: Literal["shuffled", "blocked"]  #: rows of a fold
    seed: int  #: seed of folds and models
    purge_s: float = 2.0  #: time on each side of a contiguous block that does not train

    def split_rows(self, data: Data) -> "list[Fold]":
        """Return (training rows, validation rows) of each fold of a log."""
        # imported here so that a simulation starts without scikit-learn
        from fprc.evaluation.folds import split_rows

        samples, purge = len(data.channels["time_s"]), round(self.purge_s / data.period_s)
        return split_rows(samples, self.folds, self.split, self.seed, purge)


class RigSettings(Section):
    """Settings for the simulation of the hysteresis experiments (Sec. II-B)."""

    rig: dict[str, Any]  #: section of the configuration, or a rig of a search
    control: Control
    signals: dict[str, Signal]  #: pressure signal of each experiment
    target: Literal["command", "measured"]  #: P_exp that the models learn
