"""Cheap surrogates of the models, judged on one simulated rig and seed; the full models beside.

Instead of five readouts for five folds, one is fitted to every fifth row, with the ridge
parameter scaled to the number of rows; the ESN is smaller. Features have memory: they are computed
over whole logs. The clusterings may begin at those of another rig: then the numbers of neighbouring
rigs do not jump where a clustering ends elsewhere.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from sklearn.base import RegressorMixin

from fprc.config.settings import Tracking
from fprc.evaluation.crossval import Prepared, prepare
from fprc.experiments.comparison import (
    CrossValidation,
    cross_validate_both,
    normalised,
    shares_of,
    weight_shares,
)
from fprc.experiments.data import Data, RigSettings, simulate
from fprc.experiments.tracking import Track, tracking_errors
from fprc.models import SequenceModel, TakagiSugenoReadout
from fprc.paper import DIRECTIONS, MODELS
from fprc.registry import build
from fprc.studies.calibration.objective import EPSILONS, errors_of, properties

#: Share of the rows that trains a readout in the full models' cross-validation.
_TRAINED = 0.8

#: The readouts are fitted to every n-th row.
STRIDE = 5

#: Nodes of the smaller ESN.
ESN_NODES = 100

#: Gains of the feedback over the printed ones.
LOOPS = {"open_loop": 0.0, "closed_loop": 1.0, "firm_loop": 1.5}


def judge_by_surrogate(
    on_rig: RigSettings,
    seed: int,
    centers: Mapping[str, np.ndarray],
    *,
    validation: Mapping[str, Any],
    tracking: Mapping[str, Any],
) -> dict[str, Any]:
    """Return what the objective needs of a rig, for one seed.

    Parameters
    ----------
    centers : Mapping
        Centres at which clusterings begin; those that are not in it begin at random.
    validation : Mapping
        Arguments of ``CrossValidation``; the seed is ``seed``.
    tracking : Mapping
        Section of the configuration.

    Returns
    -------
    dict
        ``errors`` by "trained on/model/phase", kPa; ``properties``, see ``objective.properties``;
        ``shares``, that of P_o in the weights over theta_d's; training errors over falling
        ``epsilon``; RMSE by reference in the loops of ``LOOPS``, deg; and the ``centers`` of all
        clusterings.
    """
    logs = simulate(on_rig, seed)
    thinned = _Thinned(logs, _adapted(validation["models"]), seed, dict(centers))
    prepared = {name: thinned.prepare(name) for name in MODELS}
    readouts = {
        (train, name): thinned.readout(prepared[name], train, f"{train}, {name}")
        for train, _ in DIRECTIONS
        for name in MODELS
    }
    model = prepared["fprc"].fitted(readouts["sweep", "fprc"])
    return {
        "errors": {
            f"{train}/{name}/{phase}": prepared[name].error(readouts[train, name], log)
            for train, test in DIRECTIONS
            for name in MODELS
            for phase, log in (("train", train), ("test", test))
        },
        "properties": properties(logs["sweep"].channels),
        "shares": {"p_o_over_theta_d": thinned.p_o_over_theta_d(prepared["fprc"])},
        "epsilon": [thinned.training_error(epsilon) for epsilon in EPSILONS],
        **_tracked(on_rig, seed, model, tracking),
        "centers": thinned.centers,
    }


def judge_fully(
    on_rig: RigSettings,
    seed: int,
    *,
    validation: Mapping[str, Any],
    tracking: Mapping[str, Any],
) -> dict[str, Any]:
    """Return what ``judge_by_surrogate`` does, errors, shares and loops of the full models."""
    how = CrossValidation(**{**validation, "seed": seed})
    data = simulate(on_rig, seed)
    of_models = {name: cross_validate_both(name, how, data) for name in MODELS}
    reports = [report for directions in of_models.values() for _, report, _ in directions]
    shares = weight_shares(data["sweep"], how)["mean_share"]
    (trained_on_sweep, *_), _ = of_models["fprc"]
    return {
        **judge_by_surrogate(on_rig, seed, {}, validation=validation, tracking=tracking),
        "errors": errors_of({"models": reports}),
        "shares": {"p_o_over_theta_d": shares["p_o"] / shares["theta_d"]},
        **_tracked(on_rig, seed, trained_on_sweep.model, tracking),
    }


def _tracked(
    on_rig: RigSettings, seed: int, model: SequenceModel, tracking: Mapping[str, Any]
) -> dict[str, dict[str, float]]:
    bench = Track(Tracking(**tracking), on_rig.control, on_rig.rig, seed)
    return tracking_errors(bench, model, LOOPS)


def _adapted(models: Mapping[str, Any]) -> dict[str, Any]:
    """Return the section ``models``, with the surrogate's ridge and nodes."""
    return {
        **models,
        "alpha": models["alpha"] / (_TRAINED * STRIDE),
        "esn": {**models["esn"], "r": ESN_NODES},
    }


class _Thinned(NamedTuple):
    """Models on every n-th row of two logs, see ``STRIDE``."""

    logs: Mapping[str, Data]
    models: Mapping[str, Any]
    seed: int
    centers: dict[str, np.ndarray]

    def prepare(self, name: str, **changed: Any) -> Prepared:
        """Return a model with its features of both logs."""
        model = build(name, self.models, self.seed, **changed)
        whole = prepare(model, {log: data.samples(name) for log, data in self.logs.items()})
        rows, y = (
            {log: values[::STRIDE] for log, values in of_logs.items()}
            for of_logs in (whole.rows, whole.y)
        )
        return whole._replace(rows=rows, y=y)

    def readout(self, prepared: Prepared, log: str, what: str) -> RegressorMixin:
        """Fit a model's readout to a log; ``what`` names its clustering, if it has one."""
        readout = prepared.model.make_readout()
        if isinstance(readout, TakagiSugenoReadout):
            readout.fit(prepared.rows[log], prepared.y[log], init=self.centers.get(what))
            self.centers.setdefault(what, readout.centers_)
            return readout
        return readout.fit(prepared.rows[log], prepared.y[log])

    def training_error(self, epsilon: float) -> float:
        """Return the RMSE of FPRC with another epsilon on the sweep that trains it, kPa."""
        prepared = self.prepare("fprc", epsilon=epsilon)
        return prepared.error(self.readout(prepared, "sweep", f"epsilon {epsilon}"), "sweep")

    def p_o_over_theta_d(self, fprc: Prepared) -> float:
        """Return the mean share of P_o in the weights over theta_d's (Eqs. 13, 14)."""
        n_y = fprc.model.n_y
        weights = shares_of(self.readout(normalised(fprc, "sweep"), "sweep", "shares").W_out_)
        return float(weights[:, 1 + n_y :].sum() / weights[:, 1 : 1 + n_y].sum())
