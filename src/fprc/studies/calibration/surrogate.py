"""Cheap surrogates of the models, judged on one simulated rig and seed.

Instead of five readouts for five folds, one is fitted to every fifth row, with the ridge
parameter scaled to the number of rows; the ESN is smaller. Features have memory: they are computed
over whole logs. The clusterings may begin at those of another rig: then the numbers of neighbouring
rigs do not jump where a clustering ends elsewhere.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from sklearn.base import RegressorMixin

from fprc.evaluation import rmse
from fprc.evaluation.crossval import Prepared, prepare
from fprc.experiments.data import Data
from fprc.experiments.grids import normalised, shares_of
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import RigSettings
from fprc.experiments.tracking import Track, measure_control, rms_of, tracking_errors
from fprc.models import TakagiSugenoReadout
from fprc.paper import CONTROLLERS, DIRECTIONS, MODELS
from fprc.registry import build
from fprc.studies.calibration.objective import properties

#: Share of the rows that trains a readout in the full models' cross-validation.
_TRAINED = 0.8

#: The readouts are fitted to every n-th row.
STRIDE = 5

#: Nodes of the smaller ESN.
ESN_NODES = 100

#: Starts of each clustering; with one, errors jump where a clustering ends elsewhere, and slopes
#: are noise.
RESTARTS = 5

#: Length of the blocks over which errors in open loop are averaged, s.
_BLOCK_S = 0.25

#: Measure of the shares of the inputs in the weights.
SHARES = "shares"

#: Optional measures, of the fit and further ones; each takes time of its own.
MEASURES = (SHARES, "epsilon", "n_c", "taps", "open_loop", "closed_loop", "firm_loop")
FURTHER = ("bias", "halves", "substitutes", "control")

#: Gains of the feedback over the printed ones.
LOOPS = {"open_loop": 0.0, "closed_loop": 1.0, "firm_loop": 1.5}


def judge_by_surrogate(
    on_rig: RigSettings,
    seed: int,
    measures: Collection[str],
    centers: dict[str, np.ndarray],
    *,
    models: Mapping[str, Any],
    grids: Mapping[str, Sequence[float]],
    tracking: Mapping[str, Any],
) -> dict[str, Any]:
    """Return what the objective needs of a rig, for one seed.

    Parameters
    ----------
    measures : collection of str
        Which of ``MEASURES`` and ``FURTHER`` to compute.
    centers : dict
        Centres of every clustering. One that is in it begins there, and all others begin at random
        and are added.
    grids : Mapping
        Values of ``epsilon`` and ``n_c``, and ``taps``, those of n_u and n_y.
    tracking : Mapping
        Section ``tracking`` of the configuration.

    Returns
    -------
    dict
        ``errors`` by "trained on/model/phase", kPa; ``properties``, see ``objective.properties``;
        and of ``measures``: ``shares``, that of P_o in the weights over theta_d's, and the share of
        the ``bias``; ``halves``, the error in the second half of the sweep over that in the first,
        by model; test errors of ``substitutes`` for P_o or for the rules, by "trained on/model";
        training errors over falling ``epsilon``; errors over rising ``n_c`` by model and phase;
        training errors over rising ``taps``, of shape (n_u, n_y); RMSE by reference in the loops of
        ``LOOPS``, deg; with ``open_loop``, ``courses`` by reference, see ``objective.numbers_of``;
        and in ``control`` what ``measure_control`` returns for FPRC.
    """
    logs = simulate(on_rig, seed)
    thinned = _Thinned(logs, _adapted(models), seed, centers)
    prepared = {name: thinned.prepare(name, logs) for name in MODELS}
    readouts = {
        (train, name): thinned.readout(prepared[name], train, f"{train}, {name}")
        for train, _ in DIRECTIONS
        for name in MODELS
    }
    judged: dict[str, Any] = {
        "errors": {
            f"{train}/{name}/{phase}": prepared[name].error(readouts[train, name], log)
            for train, test in DIRECTIONS
            for name in MODELS
            for phase, log in (("train", train), ("test", test))
        },
        "properties": properties(logs["sweep"].channels),
    }
    if wanted := {SHARES, "bias"}.intersection(measures):
        shares = thinned.shares(prepared["fprc"])
        judged |= {name: shares[name] for name in wanted}
    if "halves" in measures:
        judged["halves"] = {
            name: _second_over_first(prepared[name], readouts["complex", name]) for name in MODELS
        }
    if "substitutes" in measures:
        judged["substitutes"] = {}
        for name in ("bank", "ridge_p_o", "fprc_lowpass"):
            other = thinned.prepare(name, logs)
            for train, test in DIRECTIONS:
                readout = thinned.readout(other, train, f"{train}, {name}")
                judged["substitutes"][f"{train}/{name}"] = other.error(readout, test)
    if "epsilon" in measures:
        judged["epsilon"] = [
            thinned.training_error(epsilon=value)
            for value in sorted(grids["epsilon"], reverse=True)
        ]
    if "n_c" in measures:
        judged["n_c"] = {
            name: thinned.over_rules(prepared[name], name, sorted(grids["n_c"]))
            for name in ("fprc", "fuzzy_linear")
        }
    if "taps" in measures:
        sizes = sorted(grids["taps"])
        judged["taps"] = [
            [thinned.training_error(n_u=n_u, n_y=n_y) for n_y in sizes] for n_u in sizes
        ]
    if not {*LOOPS, "control"}.isdisjoint(measures):
        model = prepared["fprc"].fitted(readouts["sweep", "fprc"])
        bench = Track(tracking, on_rig.control, on_rig.rig, seed)
        loops = {name: gains for name, gains in LOOPS.items() if name in measures}
        tracked = tracking_errors(bench, model, loops) if loops else {}
        judged |= rms_of(tracked)
        if "open_loop" in loops:
            judged["courses"] = {
                reference: _course(error, round(_BLOCK_S * bench.control["sample_rate_hz"]))
                for reference, error in tracked["open_loop"].items()
            }
        if "control" in measures:
            judged["control"] = measure_control(logs["sweep"], bench, {"fprc": model}, CONTROLLERS)
    return judged


def _adapted(models: Mapping[str, Any]) -> dict[str, Any]:
    """Return the section ``models``, with the surrogate's ridge, nodes and starts."""
    return {
        **models,
        "alpha": models["alpha"] / (_TRAINED * STRIDE),
        "esn": {**models["esn"], "r": ESN_NODES},
        "fprc": {**models["fprc"], "restarts": RESTARTS},
    }


class _Thinned(NamedTuple):
    """Models on every n-th row of two logs, see ``STRIDE``."""

    logs: Mapping[str, Data]
    models: Mapping[str, Any]
    seed: int
    centers: dict[str, np.ndarray]

    def prepare(self, name: str, logs: Iterable[str], **changed: Any) -> Prepared:
        """Return a model with its features of some of the logs."""
        model = build(name, self.models, self.seed, **changed)
        whole = prepare(model, {log: self.logs[log].samples(name) for log in logs})
        rows, y = (
            {log: values[::STRIDE] for log, values in of_logs.items()}
            for of_logs in (whole.rows, whole.y)
        )
        return whole._replace(rows=rows, y=y)

    def readout(self, prepared: Prepared, log: str, what: str, **changed: Any) -> RegressorMixin:
        """Fit a model's readout to a log; ``what`` names its clustering, if it has one."""
        readout = prepared.model.make_readout().set_params(**changed)
        if isinstance(readout, TakagiSugenoReadout):
            readout.fit(prepared.rows[log], prepared.y[log], init=self.centers.get(what))
            self.centers.setdefault(what, readout.centers_)
            return readout
        return readout.fit(prepared.rows[log], prepared.y[log])

    def training_error(self, **changed: Any) -> float:
        """Return the RMSE of FPRC on the sweep that trains it, kPa."""
        prepared = self.prepare("fprc", ["sweep"], **changed)
        return prepared.error(self.readout(prepared, "sweep", f"{changed}"), "sweep")

    def over_rules(
        self, prepared: Prepared, name: str, n_c: Sequence[float]
    ) -> dict[str, list[float]]:
        """Return the errors of a fuzzy model that the sweep trains over n_c."""
        fitted = [
            self.readout(prepared, "sweep", f"{name}, {count} rules", n_c=count) for count in n_c
        ]
        return {
            phase: [prepared.error(readout, log) for readout in fitted]
            for phase, log in (("train", "sweep"), ("test", "complex"))
        }

    def shares(self, fprc: Prepared) -> dict[str, Any]:
        """Return the mean share of P_o in the weights over theta_d's; the bias's (Eqs. 13, 14)."""
        n_y = fprc.model.n_y
        weights = shares_of(self.readout(normalised(fprc, "sweep"), "sweep", "shares").W_out_)
        ratio = weights[:, 1 + n_y :].sum() / weights[:, 1 : 1 + n_y].sum()
        return {SHARES: {"p_o_over_theta_d": float(ratio)}, "bias": float(weights[:, 0].mean())}


def _course(error: np.ndarray, size: int) -> list[float]:
    """Return the means of an error over blocks of ``size``, relative to its RMS."""
    blocks = error[: len(error) // size * size].reshape(-1, size).mean(axis=1)
    return (blocks / np.sqrt(np.mean(error**2))).tolist()


def _second_over_first(prepared: Prepared, readout: RegressorMixin) -> float:
    """Return the RMSE of the second half of the sweep over that of the first."""
    predicted = readout.predict(prepared.rows["sweep"])
    halves = np.array_split(prepared.y["sweep"], 2), np.array_split(predicted, 2)
    first, second = map(rmse, *halves)
    return second / first
