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
from fprc.experiments.tracking import Track, measure_control, rms_of, tracking_errors
from fprc.models import TakagiSugenoReadout, lowpass, taps
from fprc.paper import CONTROLLERS, DIRECTIONS, MODELS
from fprc.registry import build, entry_of
from fprc.studies.calibration.objective import properties

#: Share of the rows that trains a readout in the full models' cross-validation.
_TRAINED = 0.8

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
    models: Mapping[str, Any],
    surrogate: Mapping[str, int],
    grids: Mapping[str, Sequence[float]],
    tracking: Mapping[str, Any],
    measures: Collection[str],
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
        Which of ``MEASURES`` and ``FURTHER`` to compute.
    centers : dict, optional
        Centres of every clustering. One that is in it begins there, and all others begin at random
        and are added.

    Returns
    -------
    dict
        ``errors`` by "trained on/model/phase", kPa; ``properties``, see ``objective.properties``;
        and of ``measures``: ``shares``, that of P_o in the weights over theta_d's, and the share of
        the ``bias``; ``halves``, the error in the second half of the sweep over that in the first,
        by model; test errors of ``substitutes`` for P_o or for the rules, by "trained on/model";
        training errors over ``epsilon``; errors over ``n_c`` by model and phase; training errors
        over ``taps``, of shape (n_u, n_y); RMSE by reference in the loops of ``LOOPS``, deg;
        with ``open_loop``, ``courses`` by reference, see ``objective.numbers_of``; and in
        ``control`` what ``measure_control`` returns for FPRC.
    """
    simulated = simulate(on_rig, seed)
    logs = {name: data.channels for name, data in simulated.items()}
    thinned = _FuzzyModels(logs, models, seed, surrogate, {} if centers is None else centers)
    fuzzy = {
        (train, name): thinned.fit(train, name) for train, _ in DIRECTIONS
        for name in ("fprc", "fuzzy_linear")
    }  # fmt: skip
    predicted = _predicted("esn", simulated, models, seed, surrogate, r=surrogate["esn_nodes"])
    for (train, name), readout in fuzzy.items():
        for log in logs:
            predicted[train, name, log] = thinned.predict(readout, log, name)
    errors = {
        f"{train}/{name}/{'train' if log == train else 'test'}": rmse(thinned.y[log], values)
        for (train, name, log), values in predicted.items()
    }
    judged: dict[str, Any] = {"errors": errors, "properties": properties(logs["sweep"])}
    if wanted := {SHARES, "bias"}.intersection(measures):
        shares = thinned.shares()
        judged |= {name: shares[name] for name in wanted}
    if "halves" in measures:
        judged["halves"] = {
            name: _second_over_first(thinned.y["sweep"], predicted["complex", name, "sweep"])
            for name in MODELS
        }
    if "substitutes" in measures:
        judged["substitutes"] = {}
        for name in ("bank", "ridge_p_o"):
            linear = _predicted(name, simulated, models, seed, surrogate)
            found = rmse(thinned.y["complex"], linear["sweep", name, "complex"])
            judged["substitutes"][f"sweep/{name}"] = found
        for train, test in DIRECTIONS:
            lowpassed = thinned.fit(train, "fprc_lowpass")
            found = thinned.error(lowpassed, test, "fprc_lowpass")
            judged["substitutes"][f"{train}/fprc_lowpass"] = found
    if "epsilon" in measures:
        judged["epsilon"] = [thinned.training_error(epsilon=value) for value in grids["epsilon"]]
    if "n_c" in measures:
        judged["n_c"] = thinned.over_rules(grids["n_c"])
    if "taps" in measures:
        judged["taps"] = [
            [thinned.training_error(n_u=n_u, n_y=n_y) for n_y in grids["n_y"]]
            for n_u in grids["n_u"]
        ]
    if not {*LOOPS, "control"}.isdisjoint(measures):
        model = build("fprc", models, seed)
        features = model.make_features().fit(np.zeros((100, 2)))
        model = model.assembled(features, fuzzy["sweep", "fprc"])
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
            judged["control"] = measure_control(
                simulated["sweep"], bench, {"fprc": model}, CONTROLLERS
            )
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
        self._taps: dict[tuple[str, str, float | None, int], np.ndarray] = {}

    def rows(self, log: str, name: str, **changed: Any) -> np.ndarray:
        """Return a model's features of a log: taps of theta, and of a second filtered input."""
        settings = self.settings | changed
        angle, *second = entry_of(name).inputs
        return np.hstack(
            [
                self._thinned(log, angle, None, settings["n_y"]),
                *(self._thinned(log, x, settings["epsilon"], settings["n_u"]) for x in second),
            ]
        )

    def fit(self, log: str, name: str, **changed: Any) -> TakagiSugenoReadout:
        """Fit a model's readout to the features of a log."""
        rows, what = self.rows(log, name, **changed), f"{log}, {name}, {changed}"
        return self._fitted(what, rows, self.y[log], **changed)

    def predict(
        self, readout: TakagiSugenoReadout, log: str, name: str, **changed: Any
    ) -> np.ndarray:
        """Return the output of a readout over a log, kPa."""
        return readout.predict(self.rows(log, name, **changed))

    def error(self, readout: TakagiSugenoReadout, log: str, name: str, **changed: Any) -> float:
        """Return the RMSE of a readout on a log, kPa."""
        return rmse(self.y[log], self.predict(readout, log, name, **changed))

    def training_error(self, **changed: Any) -> float:
        """Return the RMSE of FPRC on the sweep that trains it, kPa."""
        return self.error(self.fit("sweep", "fprc", **changed), "sweep", "fprc", **changed)

    def over_rules(self, n_c: Sequence[float]) -> dict[str, dict[str, list[float]]]:
        """Return the errors of FPRC and Fuzzy-linear over n_c."""
        judged: dict[str, dict[str, list[float]]] = {}
        for name in ("fprc", "fuzzy_linear"):
            fitted = [self.fit("sweep", name, n_c=count) for count in n_c]
            judged[name] = {
                phase: [self.error(readout, log, name) for readout in fitted]
                for phase, log in (("train", "sweep"), ("test", "complex"))
            }
        return judged

    def shares(self) -> dict[str, Any]:
        """Return the mean share of P_o in the weights over theta_d's; the bias's (Eqs. 13, 14)."""
        rows, n_y = self.rows("sweep", "fprc"), self.settings["n_y"]
        readout = self._fitted("shares", to_unit(rows, n_y), self.y["sweep"])
        weights = shares_of(readout.W_out_)
        ratio = weights[:, 1 + n_y :].sum() / weights[:, 1 : 1 + n_y].sum()
        return {SHARES: {"p_o_over_theta_d": float(ratio)}, "bias": float(weights[:, 0].mean())}

    def _fitted(
        self, what: str, rows: np.ndarray, y: np.ndarray, **changed: Any
    ) -> TakagiSugenoReadout:
        settings = self.settings | changed
        parameters = {key: settings[key] for key in ("n_c", "sigma", "clustering", "restarts")}
        readout = TakagiSugenoReadout(**parameters, alpha=self.alpha, random_state=self.seed)
        readout.fit(rows, y, init=self.centers.get(what))
        self.centers.setdefault(what, readout.centers_)
        return readout

    def _thinned(self, log: str, channel: str, epsilon: float | None, size: int) -> np.ndarray:
        key = log, channel, epsilon, size
        if key not in self._taps:
            signal = self.logs[log][channel]
            filtered = signal if epsilon is None else lowpass(signal, epsilon)
            self._taps[key] = taps(filtered, size)[:: self.stride]
        return self._taps[key]


def _course(error: np.ndarray, size: int) -> list[float]:
    """Return the means of an error over blocks of ``size``, relative to its RMS."""
    blocks = error[: len(error) // size * size].reshape(-1, size).mean(axis=1)
    return (blocks / np.sqrt(np.mean(error**2))).tolist()


def _predicted(
    name: str,
    logs: Mapping[str, Data],
    models: Mapping[str, Any],
    seed: int,
    surrogate: Mapping[str, int],
    **changed: Any,
) -> dict[tuple[str, str, str], np.ndarray]:
    """Return the outputs of a linear readout, by the log that trains, the model and the log."""
    part = slice(None, None, surrogate["stride"])
    alpha = models["alpha"] / (_TRAINED * surrogate["stride"])
    model = build(name, models, seed, alpha=alpha, **changed)
    prepared = prepare(model, {log: data.samples(name) for log, data in logs.items()})
    return {
        (train, name, log): prepared.readout(train, part).predict(prepared.rows[log][part])
        for train in logs
        for log in logs
    }


def _second_over_first(y: np.ndarray, predicted: np.ndarray) -> float:
    """Return the RMSE of the second half of a log over that of the first."""
    first, second = map(rmse, np.array_split(y, 2), np.array_split(predicted, 2))
    return second / first
