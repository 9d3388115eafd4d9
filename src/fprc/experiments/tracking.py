"""Closed-loop runs of Sec. IV: feedforward, feedback, and both."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fprc import signals
from fprc.artifacts import sha256
from fprc.channels import LEARNING_CHANNELS, TRACKING_CHANNELS
from fprc.config.settings import Control, Tracking
from fprc.control import Law, refuse_impossible, tracking_law
from fprc.devices.sim import SimulatedRig
from fprc.errors import ControlError
from fprc.escape import visible
from fprc.evaluation import rmse
from fprc.experiments.data import Data
from fprc.models import Learning, Online, SequenceModel
from fprc.paper import DISTURBANCE, REFERENCES, run_log
from fprc.registry import ANGLE, entry_of, feedforward_of, has_feedback

#: Run numbers; with the seed they set the noise. On one reference all controllers get the same
#: noise and drift, so that only the controllers differ.
TRACKING_RUNS = {"sine_0p2": 10, "sine_0p5": 20, "sweep": 30, "complex": 40, "disturbance": 50}


class Track(NamedTuple):
    """Settings that every tracking run shares."""

    tracking: Tracking
    control: Control
    rig: Mapping[str, Any]
    seed: int

    def reference(self, name: str) -> np.ndarray:
        """Return theta_d in deg, one value per sample; refuse one that the rig cannot follow."""
        rate_hz = self.control.sample_rate_hz
        theta_d = signals.reference_angle(self.tracking.reference(name), rate_hz)
        refuse_impossible(theta_d, self.control, self.tracking.angle_range_deg)
        return theta_d

    def describe(self, reference: str, controller: str) -> dict[str, Any]:
        """Return the log attributes of a controller's run, without those of the rig."""
        tracking = self.tracking.model_dump(mode="json")
        pushes = ["pushes"] if reference == DISTURBANCE else []
        read = {name: tracking[name] for name in ("angle_range_deg", "pressure_limit_kpa", *pushes)}
        read["references"] = {reference: tracking["references"][reference]}
        return {
            "experiment": run_log(reference, controller),
            "reference": reference,
            "controller": controller,
            "settle_s": self.tracking.reference(reference).settle_s,
            "sample_rate_hz": self.control.sample_rate_hz,
            "seed": self.seed,
            "rig": {"control": self.control.model_dump(mode="json"), "tracking": read},
        }

    def pushes(self, samples: int) -> np.ndarray:
        """Return the pushes of the disturbance test, kPa."""
        rng, shape = np.random.default_rng([self.seed, 4711]), dict(self.tracking.pushes)
        return signals.random_pushes(samples, self.control.sample_rate_hz, rng=rng, **shape)

    def law(self, theta_d: np.ndarray, controller: str, model: SequenceModel | None) -> Law:
        """Return the law of a controller; its model, which it may need, is reset."""
        used, online = None, None
        if driver := feedforward_of(controller):
            if (used := model) is None:
                raise ControlError(f"{controller} needs a fitted {driver}; give --model its file")
            used.reset()
            online = self.online(used) if self.control.feedforward.adapt else None
        limit_kpa, feedback = self.tracking.pressure_limit_kpa, has_feedback(controller)
        return tracking_law(
            theta_d, self.control, limit_kpa, model=used, online=online, feedback=feedback
        )

    def channels(self, controller: str) -> tuple[str, ...]:
        """Return the names of what the law of a controller returns after the two setpoints."""
        learns = self.control.feedforward.adapt and feedforward_of(controller)
        return (*TRACKING_CHANNELS, *LEARNING_CHANNELS) if learns else TRACKING_CHANNELS

    def follow(
        self, reference: str, controllers: Sequence[str], models: Mapping[str, SequenceModel]
    ) -> dict[str, dict[str, np.ndarray]]:
        """Follow a reference on the simulated rig; return the channels of each controller."""
        inputs, runs = self.inputs(reference), {}
        for name in controllers:
            driver = feedforward_of(name)
            p_ff = self.precompute(models[driver], inputs) if driver else None
            runs[name] = self.simulate(reference, p_ff, feedback=has_feedback(name))
        return runs

    def inputs(self, reference: str) -> np.ndarray:
        """Return the inputs of the models for a whole reference, of shape (n_samples, 2).

        P_o depends on P_i = K_in theta_d only, so one run with the actuator at rest gives it.
        """
        at_rest = self.simulate(reference, None, feedback=False)
        p_o_kpa = at_rest["p_o_kpa"] + self.control.feedforward.p_o_shift_kpa
        return np.column_stack([at_rest["theta_d_deg"], p_o_kpa])

    def precompute(self, model: SequenceModel, inputs: np.ndarray) -> dict[str, Any]:
        """Return P_ff of a model for a whole reference, as ``SimulatedRig.follow`` takes it.

        If the model learns in the run, P_ff is that of the model as it was trained; ``online`` is
        the one that learns, with its ``regressors``.
        """
        X = inputs[:, : model.n_features_in_]
        if not self.control.feedforward.adapt:
            return {"p_ff_kpa": model.predict(X)}
        online, rows = self.online(model), model.features_.map_log(X)
        phi = np.ascontiguousarray(model.readout_.regressors(rows))
        return {"p_ff_kpa": model.readout_.predict(rows), "online": online, "regressors": phi}

    def online(self, model: SequenceModel) -> Online:
        """Return the model as it learns in a run, by the section ``control.feedforward``."""
        chosen = self.control.feedforward
        learning = Learning(*(getattr(chosen, name) for name in Learning._fields))
        period_s = 1.0 / self.control.sample_rate_hz
        try:
            return Online(model, learning, period_s, self.tracking.pressure_limit_kpa)
        except ValueError as error:
            raise ControlError(f"control.feedforward.adapt: {error}") from error

    def simulate(
        self, reference: str, precomputed: Mapping[str, Any] | None, *, feedback: bool
    ) -> dict[str, np.ndarray]:
        """Return the channels of a run, simulated in compiled code.

        They are those of ``law`` in the loop of the real rig; without a precomputed feedforward
        P_ff = 0. In the disturbance test the reservoir is pushed.
        """
        theta_d, rate_hz = self.reference(reference), self.control.sample_rate_hz
        given = precomputed or {"p_ff_kpa": np.zeros(len(theta_d))}
        number = TRACKING_RUNS[reference]
        device = SimulatedRig(self.rig, seed=self.seed, run=number, sample_rate_hz=rate_hz)
        pushes = self.pushes(len(theta_d)) if reference == DISTURBANCE else None
        limit_kpa = self.tracking.pressure_limit_kpa
        return device.follow(
            self.control, theta_d_deg=theta_d, pressure_limit_kpa=limit_kpa, feedback=feedback,
            push_kpa=pushes, **given,
        )  # fmt: skip


def describe_model(model: SequenceModel, path: Path | str) -> dict[str, str]:
    """Return the log attributes of the model of a run: its class, and the file that held it."""
    return {
        "model": type(model).__name__,
        "model_file": visible(Path(path).name),
        "model_sha256": sha256(str(path)),
    }


def tracking_rmse(channels: Mapping[str, np.ndarray], settle_s: float) -> float:
    """Return the RMSE of theta against theta_d after the settling time, deg."""
    run = signals.settled(channels, settle_s)
    return rmse(run["theta_d_deg"], run["theta_deg"])


def measure_control(
    sweep: Data, bench: Track, models: Mapping[str, SequenceModel], controllers: Sequence[str]
) -> dict[str, Any]:
    """Follow every reference with every controller; return what the claims measure."""
    still = bench.tracking.pushes.changed(sigma_kpa=0.0)
    quiet = bench._replace(tracking=bench.tracking.changed(pushes=still))
    settle_s = {name: reference.settle_s for name, reference in bench.tracking.references}
    runs = {
        f"{reference}/{name}": signals.settled(run, settle_s[reference])
        for reference in settle_s
        for name, run in bench.follow(reference, controllers, models).items()
    }
    unpushed = quiet.follow(DISTURBANCE, ["fprc_pd"], models)["fprc_pd"]
    unpushed = signals.settled(unpushed, settle_s[DISTURBANCE])
    return {
        "hysteresis": signals.measure_hysteresis(sweep.channels),
        "range": signals.measure_range(sweep.channels),
        "pressure_error": signals.measure_pressure_error(sweep.channels),
        **signals.measure_runs(runs, unpushed, bench.tracking.pushes.quiet_s),
    }


def columns_for(name: str, inputs: np.ndarray) -> np.ndarray:
    """Return the columns that a model takes of ``Track.inputs``; several may be the angle."""
    return np.take(inputs, [int(channel != ANGLE) for channel in entry_of(name).inputs], axis=1)


def tracking_errors(
    bench: Track,
    model: SequenceModel | None,
    loops: Mapping[str, float],
    inputs: Mapping[str, np.ndarray] | None = None,
) -> dict[str, dict[str, float]]:
    """Return the RMSE with P_ff of one model, or none, over each reference of Table IV, deg.

    ``loops`` has by name what multiplies the gains of the feedback, or 0 without feedback;
    ``inputs`` are by reference, by default those of ``Track.inputs``.
    """
    errors: dict[str, dict[str, float]] = {name: {} for name in loops}
    for reference in REFERENCES:
        given = bench.inputs(reference) if inputs is None else inputs[reference]
        for name, gains in loops.items():
            pd = bench.control.pd.changed(**{key: gains * gain for key, gain in bench.control.pd})
            loop = bench._replace(control=bench.control.changed(pd=pd))
            precomputed = loop.precompute(model, given) if model else None
            run = loop.simulate(reference, precomputed, feedback=gains > 0.0)
            settle_s = bench.tracking.reference(reference).settle_s
            errors[name][reference] = tracking_rmse(run, settle_s)
    return errors
