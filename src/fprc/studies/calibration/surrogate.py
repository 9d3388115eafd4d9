"""Cheap surrogates of the models, judged on one simulated rig and seed; the full models beside.

Instead of five readouts for five folds, one is fitted to every fifth row, with the ridge
parameter scaled to the number of rows; the ESN is smaller. Features have memory: they are computed
over whole logs. The clusterings may begin at those of another rig: then the numbers of neighbouring
rigs do not jump where a clustering ends elsewhere.
"""

from collections.abc import Mapping
from typing import Any

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
from fprc.experiments.data import RigSettings, simulate
from fprc.experiments.tracking import Track, tracking_errors
from fprc.models import SequenceModel, TakagiSugenoReadout
from fprc.paper import DIRECTIONS, MODELS
from fprc.registry import build
from fprc.studies.calibration.objective import EPSILONS, properties

Settings = Mapping[str, Any]

#: Share of the rows that trains a readout in the full models' cross-validation; the readouts here
#: are fitted to every n-th row; nodes of the smaller ESN.
_TRAINED, STRIDE, ESN_NODES = 0.8, 5, 100

#: Gains of the feedback over the printed ones.
LOOPS = {"open_loop": 0.0, "closed_loop": 1.0, "firm_loop": 1.5}


def judge_loops(on_rig: RigSettings, seed: int, **_: Any) -> dict[str, Any]:
    """Return the properties of a rig's loops in the sweep alone."""
    signals = {"sweep": on_rig.signals["sweep"]}
    sweep = simulate(on_rig.changed(signals=signals), seed)["sweep"]
    return {"properties": properties(sweep.channels)}


def judge_by_surrogate(
    on_rig: RigSettings, seed: int, centers: Settings, *, validation: Settings, tracking: Settings
) -> dict[str, Any]:
    """Return what the objective needs of a rig, for one seed.

    Groups of numbers: ``errors`` by "trained on/model/phase", kPa; ``properties``, see
    ``objective.properties``; ``shares``, that of P_o in the weights over theta_d's (Eqs. 13, 14);
    training errors over falling ``epsilon``; RMSE by reference in each of ``LOOPS``, deg. Also the
    ``centers`` of all clusterings, which begin at those that are given, else at random.
    ``validation`` has the arguments of ``CrossValidation`` but for the seed; ``tracking`` is the
    section of the configuration.
    """
    logs, models, centers = simulate(on_rig, seed), validation["models"], dict(centers)
    alpha, esn = models["alpha"] / (_TRAINED * STRIDE), {**models["esn"], "r": ESN_NODES}
    models = {**models, "alpha": alpha, "esn": esn}

    def thinned(name: str, **changed: Any) -> Prepared:
        samples = {log: data.samples(name) for log, data in logs.items()}
        whole = prepare(build(name, models, seed, **changed), samples)
        rows = {log: values[::STRIDE] for log, values in whole.rows.items()}
        y = {log: values[::STRIDE] for log, values in whole.y.items()}
        return whole._replace(rows=rows, y=y)

    def fitted(prepared: Prepared, log: str, what: str) -> RegressorMixin:
        """Fit a readout to a log; ``what`` names its clustering, if it has one."""
        readout = prepared.model.make_readout()
        if not isinstance(readout, TakagiSugenoReadout):
            return readout.fit(prepared.rows[log], prepared.y[log])
        readout.fit(prepared.rows[log], prepared.y[log], init=centers.get(what))
        centers.setdefault(what, readout.centers_)
        return readout

    prepared = {name: thinned(name) for name in MODELS}
    readouts, errors, epsilons = {}, {}, []
    for train, test in DIRECTIONS:
        for name, of_model in prepared.items():
            readout = readouts[train, name] = fitted(of_model, train, f"{train}, {name}")
            errors[f"{train}/{name}/train"] = of_model.error(readout, train)
            errors[f"{train}/{name}/test"] = of_model.error(readout, test)
    for epsilon in EPSILONS:
        changed = thinned("fprc", epsilon=epsilon)
        epsilons.append(changed.error(fitted(changed, "sweep", f"epsilon {epsilon}"), "sweep"))
    fprc = prepared["fprc"]
    weights = shares_of(fitted(normalised(fprc, "sweep"), "sweep", "shares").W_out_)
    _, of_theta_d, of_p_o = np.split(weights, [1, 1 + fprc.model.n_y], axis=1)
    return {
        "errors": errors,
        "properties": properties(logs["sweep"].channels),
        "shares": {"p_o_over_theta_d": float(of_p_o.sum() / of_theta_d.sum())},
        "epsilon": epsilons,
        **_tracked(on_rig, seed, fprc.fitted(readouts["sweep", "fprc"]), tracking),
        "centers": centers,
    }


def judge_fully(
    on_rig: RigSettings, seed: int, *, validation: Settings, tracking: Settings
) -> dict[str, Any]:
    """Return what ``judge_by_surrogate`` does, errors, shares and loops of the full models."""
    how = CrossValidation(**{**validation, "seed": seed})
    data, errors = simulate(on_rig, seed), {}
    of_models = {name: cross_validate_both(name, how, data) for name in MODELS}
    for name, directions in of_models.items():
        for _, report, _ in directions:
            key = f"{report['trained_on']}/{name}"
            errors[f"{key}/train"] = float(np.mean(report["train_rmse_kpa"]))
            errors[f"{key}/test"] = float(report["test_rmse_kpa"])
    shares = weight_shares(data["sweep"], how)["mean_share"]
    (trained_on_sweep, *_), _ = of_models["fprc"]
    return {
        **judge_by_surrogate(on_rig, seed, {}, validation=validation, tracking=tracking),
        "errors": errors,
        "shares": {"p_o_over_theta_d": shares["p_o"] / shares["theta_d"]},
        **_tracked(on_rig, seed, trained_on_sweep.model, tracking),
    }


def _tracked(
    on_rig: RigSettings, seed: int, model: SequenceModel, tracking: Settings
) -> dict[str, dict[str, float]]:
    bench = Track(Tracking(**tracking), on_rig.control, on_rig.rig, seed)
    return tracking_errors(bench, model, LOOPS)
