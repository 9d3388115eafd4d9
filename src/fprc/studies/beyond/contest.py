"""The paper's models and their competitors on one rig: errors, tracking, and a shifted P_o."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from fprc.config.tracking import Tracking
from fprc.errors import FprcError, in_one_line
from fprc.evaluation import rmse
from fprc.evaluation.crossval import prepare
from fprc.experiments.data import Data
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import RigSettings, Unit
from fprc.experiments.tracking import Track, columns_for
from fprc.models import SequenceModel
from fprc.paper import REFERENCES
from fprc.registry import COMPETITORS, build, entry_of
from fprc.signals import rms
from fprc.studies.beyond.measurements import LOOPS

#: Models judged on every rig: those that a claim compares, and one competitor of every other kind.
BRIEF = (
    "fprc", "fprc_lowpass", "fuzzy_linear", "ridge_p_o", "bank_p_o", "bank", "plays", "fprc_tuned",
    "fprc_lowpass_tuned",
)  # fmt: skip
#: Models that take long, so they are judged on fewer rigs or seeds.
SLOW = ("esn", "esn_oracle", "trees", "mlp")
#: Models judged in the forward direction only: claims compare only their test errors.
FORWARD_ONLY = ("esn_tuned", "esn_matched", "esn_oracle")
#: All models; ``registry.CHOICES`` explains the suffixes.
ALL = (
    *COMPETITORS,
    "fprc_tuned", "fprc_lowpass_tuned", "esn_tuned", "bank_tuned", "plays_tuned", "esn_matched",
    "fprc_oracle", "esn_oracle", "bank_oracle", "plays_oracle",
)  # fmt: skip


class Contest(NamedTuple):
    """How the models are built, and how P_o is shifted."""

    models: Mapping[str, Any]  #: section ``models`` of the configuration
    tuned: Mapping[str, Any]  #: settings that differ from the defaults, by name with suffix
    tracking: Mapping[str, Any]  #: section of the configuration
    shifts_kpa: Sequence[float]  #: constant offsets of P_o

    def build(self, name: str, seed: int) -> SequenceModel:
        """Return the unfitted model of that name."""
        return build(name, self.models, seed, **self.tuned.get(name, {}))


def judge_models(unit: Unit, *, contest: Mapping[str, Any], slow: int) -> list[dict[str, Any]]:
    """Judge all models, or those of ``BRIEF``, on every simulated rig of a unit.

    Parameters
    ----------
    contest : Mapping
        Arguments of ``Contest`` without ``tuned``, which the unit's family has, as in the functions
        below. The family also has ``every_model``.
    slow : int
        Number of the first units that also judge the slow models.

    Returns
    -------
    list of dict
        For each simulated rig: ``seed``, and ``models``, see ``judge_rig``, or ``failed``, the
        message.
    """
    entered = Contest(**contest, tuned=unit.family["tuned"])
    names: Sequence[str] = BRIEF
    if unit.family["every_model"]:
        names = [name for name in ALL if name not in SLOW or unit.number < slow]
    judged = []
    for on_rig, seed in unit.rigs:
        try:
            report: dict[str, Any] = {"models": judge_rig(on_rig, seed, names, entered)}
        except FprcError as error:
            report = {"failed": in_one_line(error)}
        judged.append({"seed": seed, **report})
    return judged


def judge_rig(
    on_rig: RigSettings, seed: int, names: Sequence[str], contest: Contest
) -> dict[str, dict[str, Any]]:
    """Simulate both experiments on a rig, and judge every model on them.

    Returns
    -------
    dict of dict
        By model: ``train`` (training RMSE of the forward direction, kPa), ``forward`` and
        ``reversed`` (test RMSE, kPa), ``open_loop`` and ``closed_loop`` (root mean square over the
        four references, deg); with an offset of P_o, of a model that reads it ``forward/KPA``, and
        of FPRC ``open_loop/KPA`` and ``closed_loop/KPA``. Models of ``FORWARD_ONLY`` have neither
        ``reversed`` nor tracking errors. A model that cannot be judged has ``failed``, the message.
    """
    logs = simulate(on_rig, seed)
    sweep, complex_ = logs["sweep"], logs["complex"]
    bench = Track(Tracking(**contest.tracking), on_rig.control, on_rig.rig, seed)
    followed = {name: bench.inputs(name) for name in REFERENCES}
    judged = {}
    for name in names:
        try:
            model, train, forward = _trained(name, sweep, complex_, contest, seed)
            report: dict[str, Any] = {"train": train, "forward": forward}
            if name not in FORWARD_ONLY:
                _, _, report["reversed"] = _trained(name, complex_, sweep, contest, seed)
                report |= _follow(bench, model, name, followed)
            if name == "fprc":
                for shift in contest.shifts_kpa:
                    inputs = {key: values + [0.0, shift] for key, values in followed.items()}
                    found = _follow(bench, model, name, inputs)
                    report |= {f"{loop}/{shift:g}": value for loop, value in found.items()}
            if "p_o_kpa" in entry_of(name).inputs:
                X, expected, _ = complex_.samples(name)
                report |= {
                    f"forward/{shift:g}": rmse(expected, model.predict(X + [0.0, shift]))
                    for shift in contest.shifts_kpa
                }
            judged[name] = report
        except (FprcError, ValueError, np.linalg.LinAlgError) as error:
            judged[name] = {"failed": in_one_line(error)}
    return judged


def _trained(
    name: str, train: Data, test: Data, contest: Contest, seed: int
) -> tuple[SequenceModel, float, float]:
    """Return a model with its training and its test error, kPa."""
    logs = {"train": train.samples(name), "test": test.samples(name)}
    prepared = prepare(contest.build(name, seed), logs)
    readout = prepared.readout("train")
    errors = prepared.error(readout, "train"), prepared.error(readout, "test")
    return prepared.fitted(readout), *errors


def _follow(
    bench: Track, model: SequenceModel, name: str, followed: Mapping[str, np.ndarray]
) -> dict[str, float]:
    """Return the error over the references, deg, with feedforward alone and with PD."""
    errors: dict[str, list[float]] = {loop: [] for loop in LOOPS}
    for reference, inputs in followed.items():
        precomputed = bench.precompute(model, columns_for(name, inputs))
        for loop, feedback in zip(LOOPS, (False, True), strict=True):
            errors[loop].append(bench.error(reference, precomputed, feedback=feedback))
    return {loop: rms(np.array(of_loop)) for loop, of_loop in errors.items()}
