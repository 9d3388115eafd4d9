"""Cheap surrogates of the models, judged on one simulated rig and seed.

Instead of five readouts for five folds, one is fitted to every ``stride``-th row, with the ridge
parameter scaled to the number of rows; the ESN is smaller. Features have memory: they are computed
over whole logs, once for all cells of the grids. The clusterings may begin at those of another rig:
then the numbers of neighbouring rigs do not jump where a clustering ends elsewhere.
"""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from fprc.evaluation import rmse
from fprc.evaluation.crossval import prepare
from fprc.evaluation.weights import shares_of, to_unit
from fprc.experiments.data import Data
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import RigSettings
from fprc.experiments.tracking import Track, rms_of, tracking_errors
from fprc.models import TakagiSugenoReadout, lowpass, taps
from fprc.paper import DIRECTIONS
from fprc.registry import build
from fprc.studies.calibration.objective import properties

#: Share of the rows that trains a readout in the full models' cross-validation.
_TRAINED = 0.8

#: Length of the blocks over which errors in open loop are averaged, s.
_BLOCK_S = 0.25

#: Optional measures; each takes time of its own.
MEASURES = ("shares", "epsilon", "n_c", "taps", "open_loop", "closed_loop")

#: Whether a loop has feedback.
LOOPS = {"open_loop": False, "closed_loop": True}


def judge_by_surrogate(
    on_rig: RigSettings,
    seed: int,
    models: Mapping[str, Any],
    surrogate: Mapping[str, int],
    grids: Mapping[str, Sequence[float]],
    tracking: Mapping[str, Any],
    measures: Collection[str] = (),
    centers: dict[str, np.ndarray] | None = None,
) -> dict[str, Any]:
    """Return what the objective needs of a rig, for one seed.

    Parameters
    ----------
    surrogate : Mapping
        ``stride``, ``esn_nodes`` and ``restarts``.
    grids : Mapping
        Values of ``epsilon``, falling, and of ``n_c``, ``n_u`` and ``n_y``, rising.
    tracking : Mapping
        Section ``tracking`` of the configuration.
    measures : collection of str
        Which of ``MEASURES`` to compute.
    centers : dict, optional
        Centres of every clustering. One that is in it begins there, and all others begin at random
        and are added.

    Returns
    -------
    dict
        ``errors`` by "trained on/model/phase", kPa; ``properties``, see ``objective.properties``;
        and of ``measures``: ``shares`` of P_o over theta_d in the weights; training errors over
        ``epsilon``; errors over ``n_c`` by model and phase; training errors over ``taps``, of
        shape (n_u, n_y); RMSE by reference in ``open_loop`` and ``closed_loop``, deg; and, with
        ``open_loop``, ``courses`` by reference, see ``objective.numbers_of``.
    """
    simulated = simulate(on_rig, seed)
    logs = {name: data.channels for name, data in simulated.items()}
    thinned = _FuzzyModels(logs, models, seed, surrogate, {} if centers is None else centers)
    fuzzy = {
        (train, name): thinned.fit(train, name == "fprc") for train, _ in DIRECTIONS
        for name in ("fprc", "fuzzy_linear")
    }  # fmt: skip
    errors = _esn_errors(simulated, models, seed, surrogate)
    for (train, name), readout in fuzzy.items():
        for phase, log in zip(("train", "test"), (train, *(set(logs) - {train})), strict=True):
            errors[f"{train}/{name}/{phase}"] = thinned.error(readout, log, name == "fprc")
    judged: dict[str, Any] = {"errors": errors, "properties": properties(logs)}
    if "shares" in measures:
        judged["shares"] = thinned.shares()
    if "epsilon" in measures:
        judged["epsilon"] = [
            thinned.error(thinned.fit("sweep", True, epsilon=value), "sweep", True, epsilon=value)
            for value in grids["epsilon"]
        ]
    if "n_c" in measures:
        judged["n_c"] = thinned.over_rules(grids["n_c"])
    if "taps" in measures:
        judged["taps"] = [
            [
                thinned.error(thinned.fit("sweep", True, n_u=u, n_y=y), "sweep", True, n_u=u, n_y=y)
                for y in grids["n_y"]
            ]
            for u in grids["n_u"]
        ]
    if loops := {name: feedback for name, feedback in LOOPS.items() if name in measures}:
        model = build("fprc", models, seed)
        features = model.make_features().fit(np.zeros((100, 2)))
        model = model.assembled(features, fuzzy["sweep", "fprc"])
        bench = Track(tracking, on_rig.control, on_rig.rig, seed)
        tracked = tracking_errors(bench, model, loops)
        judged |= rms_of(tracked)
        if "open_loop" in loops:
            judged["courses"] = {
                reference: _course(error, round(_BLOCK_S * bench.control["sample_rate_hz"]))
                for reference, error in tracked["open_loop"].items()
            }
    return judged


class _FuzzyModels:
    """The fuzzy models on every ``stride``-th row of two logs."""

    def __init__(
        self,
        logs: Mapping[str, Mapping[str, np.ndarray]],
        models: Mapping[str, Any],
        seed: int,
        surrogate: Mapping[str, int],
        centers: dict[str, np.ndarray],
    ):
        self.centers = centers
        self.logs, stride = logs, surrogate["stride"]
        self.settings = {
            **models["fprc"], "n_y": models["n_y"], "restarts": surrogate["restarts"]
        }  # fmt: skip
        self.alpha = models["alpha"] / (_TRAINED * stride)
        self.seed, self.stride = seed, stride
        self.y = {name: log["p_target_kpa"][::stride] for name, log in logs.items()}
        self._taps: dict[tuple[str, float | None, int], np.ndarray] = {}

    def rows(self, log: str, reservoir: bool, **changed: Any) -> np.ndarray:
        """Return the taps of theta in a log, and with ``reservoir`` those of the filtered P_o."""
        settings = self.settings | changed
        theta = self._thinned(log, None, settings["n_y"])
        if not reservoir:
            return theta
        return np.hstack([theta, self._thinned(log, settings["epsilon"], settings["n_u"])])

    def fit(self, log: str, reservoir: bool, **changed: Any) -> TakagiSugenoReadout:
        """Fit a readout to the features of a log."""
        rows, what = self.rows(log, reservoir, **changed), f"{log}, {reservoir}, {changed}"
        return self._fitted(what, rows, self.y[log], **changed)

    def error(
        self, readout: TakagiSugenoReadout, log: str, reservoir: bool, **changed: Any
    ) -> float:
        """Return the RMSE of a readout on a log, kPa."""
        return rmse(self.y[log], readout.predict(self.rows(log, reservoir, **changed)))

    def over_rules(self, n_c: Sequence[float]) -> dict[str, dict[str, list[float]]]:
        """Return the errors of FPRC and Fuzzy-linear over n_c."""
        judged: dict[str, dict[str, list[float]]] = {}
        for name in ("fprc", "fuzzy_linear"):
            reservoir = name == "fprc"
            fitted = [self.fit("sweep", reservoir, n_c=count) for count in n_c]
            judged[name] = {
                phase: [self.error(readout, log, reservoir) for readout in fitted]
                for phase, log in (("train", "sweep"), ("test", "complex"))
            }
        return judged

    def shares(self) -> float:
        """Return the mean share of P_o in the weights over that of theta_d (Eqs. 13, 14)."""
        rows, n_y = self.rows("sweep", True), self.settings["n_y"]
        readout = self._fitted("shares", to_unit(rows, n_y), self.y["sweep"])
        weights = shares_of(readout.W_out_)
        return float(weights[:, 1 + n_y :].sum() / weights[:, 1 : 1 + n_y].sum())

    def _fitted(
        self, what: str, rows: np.ndarray, y: np.ndarray, **changed: Any
    ) -> TakagiSugenoReadout:
        settings = self.settings | changed
        parameters = {key: settings[key] for key in ("n_c", "sigma", "clustering", "restarts")}
        readout = TakagiSugenoReadout(**parameters, alpha=self.alpha, random_state=self.seed)
        readout.fit(rows, y, init=self.centers.get(what))
        self.centers.setdefault(what, readout.centers_)
        return readout

    def _thinned(self, log: str, epsilon: float | None, size: int) -> np.ndarray:
        key = log, epsilon, size
        if key not in self._taps:
            signal = (
                self.logs[log]["theta_deg"]
                if epsilon is None
                else lowpass(self.logs[log]["p_o_kpa"], epsilon)
            )
            self._taps[key] = taps(signal, size)[:: self.stride]
        return self._taps[key]


def _course(error: np.ndarray, size: int) -> list[float]:
    """Return the means of an error over blocks of ``size``, relative to its RMS."""
    blocks = error[: len(error) // size * size].reshape(-1, size).mean(axis=1)
    return (blocks / np.sqrt(np.mean(error**2))).tolist()


def _esn_errors(
    logs: Mapping[str, Data],
    models: Mapping[str, Any],
    seed: int,
    surrogate: Mapping[str, int],
) -> dict[str, float]:
    stride = surrogate["stride"]
    changed = {"r": surrogate["esn_nodes"], "alpha": models["alpha"] / (_TRAINED * stride)}
    model = build("esn", models, seed, **changed)
    prepared = prepare(model, {name: log.samples("esn") for name, log in logs.items()})
    part, errors = slice(None, None, stride), {}
    for train, test in DIRECTIONS:
        readout = prepared.readout(train, part)
        for phase, log in (("train", train), ("test", test)):
            errors[f"{train}/esn/{phase}"] = prepared.error(readout, log, part)
    return errors
