"""The paper's models and their competitors on one rig: errors, tracking, and a shifted P_o."""

from collections.abc import Mapping, Sequence
from itertools import chain
from typing import Any

import numpy as np

from fprc.config.settings import Tracking
from fprc.errors import FprcError, in_one_line
from fprc.evaluation import rmse
from fprc.evaluation.capacity import filtered_capacity
from fprc.evaluation.crossval import prepare
from fprc.evaluation.sides import Recordings, block_errors
from fprc.experiments.data import Data, simulate
from fprc.experiments.tracking import Track, columns_for, tracking_errors
from fprc.models import SequenceModel
from fprc.paper import EXPERIMENTS, REFERENCES
from fprc.registry import COMPETITORS, SIDES, build
from fprc.signals import rms
from fprc.studies.family import Unit

#: Models judged on every rig: those that a claim compares, the families of both sides among them.
BRIEF = tuple(dict.fromkeys([*chain(*SIDES.values()), "fuzzy_linear", "ridge_p_o"]))
#: Models that take long, so they are judged on fewer rigs or seeds.
SLOW = ("esn", "trees", "mlp")
#: What B8 asks of P_o's capacity of degree 2 and above; a capacity counts as this at least, and so
#: does a memory, s: ratios need a number.
NONLINEAR, LEAST = 0.1, 1e-3


def judge_models(
    unit: Unit, *, models: Mapping[str, Any], tracking: Mapping[str, Any], slow: int
) -> dict[str, Any]:
    """Return the errors of all models on a unit's rig, or of those of ``BRIEF``, as ``models``.

    By model ``train`` (training RMSE of the forward direction, kPa), ``forward`` and ``reversed``
    (test RMSE, kPa), ``open_loop`` and ``closed_loop`` (root mean square over the four references,
    deg); of FPRC with P_o 2 kPa low ``forward/-2``, ``open_loop/-2`` and ``closed_loop/-2``; of a
    model of ``SIDES`` ``blocks``, its error on unseen blocks of both logs, kPa. A model that cannot
    be judged has ``failed``, the message. The first ``slow`` units also judge the slow models. Of
    ``p_o`` and ``theta``: ``memory_s`` and ``nonlinear``, capacity of degree 2 and above, on the
    sweep; of ``threshold``: ``nonlinear``.
    """
    names: Sequence[str] = BRIEF
    if unit.every_model:
        names = [name for name in COMPETITORS if name not in SLOW or unit.number < slow]
    logs, seed = simulate(unit.on_rig, unit.seed), unit.seed
    bench = Track(Tracking(**tracking), unit.on_rig.control, unit.on_rig.rig, seed)
    followed = {name: bench.inputs(name) for name in REFERENCES}
    low = [0.0, -2.0]  # kPa
    followed_low = {reference: inputs + low for reference, inputs in followed.items()}
    blocks = block_errors(_recordings(*(logs[name] for name in EXPERIMENTS)), models, seed)
    judged: dict[str, dict[str, Any]] = {}
    for name in names:
        try:
            model, train, forward = _trained(name, logs, EXPERIMENTS, models, seed)
            *_, backward = _trained(name, logs, EXPERIMENTS[::-1], models, seed)
            report = {"train": train, "forward": forward, "reversed": backward}
            report |= _follow(bench, model, name, followed)
            if name in blocks:
                report["blocks"] = blocks[name]
            if name == "fprc":
                X, expected, _ = logs["complex"].samples(name)
                report["forward/-2"] = rmse(expected, model.predict(X + low))
                for loop, error in _follow(bench, model, name, followed_low).items():
                    report[f"{loop}/-2"] = error
            judged[name] = report
        except (FprcError, ValueError) as error:
            judged[name] = {"failed": in_one_line(error)}
    return {"models": judged | _remembered(_recordings(logs["sweep"]))}


def _recordings(*logs: Data) -> Recordings:
    """Return logs as what the comparison of two sides takes, thinned."""
    theta, p_o, target = (
        np.concatenate([log.channels[name] for log in logs])
        for name in ("theta_deg", "p_o_kpa", "p_target_kpa")
    )
    lengths = [length for log in logs for length in log.lengths]
    return Recordings(theta, p_o, target, lengths, 1.0 / logs[0].period_s).thinned()


def _trained(
    name: str, logs: Mapping[str, Data], order: Sequence[str], models: Mapping[str, Any], seed: int
) -> tuple[SequenceModel, float, float]:
    """Return a model with its errors on the log that trains and on the one that tests, kPa."""
    prepared = prepare(build(name, models, seed), {key: logs[key].samples(name) for key in order})
    readout = prepared.readout(order[0])
    trained, tested = (prepared.error(readout, key) for key in order)
    return prepared.fitted(readout), trained, tested


def _remembered(sweep: Recordings) -> dict[str, dict[str, float]]:
    """Return memory and nonlinear capacity of P_o and of theta, each with its low-passes."""
    found = {"threshold": {"nonlinear": NONLINEAR}}
    for name, signal in (("p_o", sweep.p_o), ("theta", sweep.theta)):
        one = filtered_capacity(signal, sweep.theta, sweep.rate_hz)
        nonlinear = float(one.degrees[1:].sum())
        found[name] = {"memory_s": max(one.memory_s, LEAST), "nonlinear": max(nonlinear, LEAST)}
    return found


def _follow(
    bench: Track, model: SequenceModel, name: str, followed: Mapping[str, np.ndarray]
) -> dict[str, float]:
    """Return the error over the references, deg, with feedforward alone and with PD."""
    given = {reference: columns_for(name, inputs) for reference, inputs in followed.items()}
    errors = tracking_errors(bench, model, {"open_loop": 0.0, "closed_loop": 1.0}, given)
    return {loop: rms(np.array([*of_loop.values()])) for loop, of_loop in errors.items()}
