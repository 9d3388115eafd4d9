"""Closed-loop runs of Sec. IV: feedforward, feedback, and both."""

import logging
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from fprc import __version__
from fprc.control import PD, Law, PressurePI, feedforward, refuse_impossible, run, tracking_law
from fprc.control.simulated import simulate_tracking
from fprc.devices.sim import SimulatedRig
from fprc.evaluation import rmse
from fprc.experiments.data import Data
from fprc.experiments.measures import measure_hysteresis, measure_runs
from fprc.logs import TRACKING_CHANNELS
from fprc.models import SequenceModel
from fprc.paper import DISTURBANCE, GAINS, REFERENCES, controller_and_gain, run_log
from fprc.registry import feedforward_of
from fprc.signals import random_pushes, reference_angle

log = logging.getLogger(__name__)

#: Run numbers; with the seed they set the noise. On one reference all controllers get the same
#: noise and drift, so that only the controllers differ.
TRACKING_RUNS = {
    "sine_0p2": 10,
    "sine_0p5": 20,
    "sweep": 30,
    "complex": 40,
    "disturbance": 50,
    "identification": 60,
}


class Track(NamedTuple):
    """Settings that every tracking run shares."""

    tracking: Mapping[str, Any]
    control: Mapping[str, Any]
    rig: Mapping[str, Any]
    seed: int

    def reference(self, name: str) -> np.ndarray:
        """Return theta_d in deg, one value per sample.

        Raises
        ------
        ControlError
            The rig cannot follow the reference.
        """
        rate_hz = self.control["sample_rate_hz"]
        theta_d = reference_angle(self.tracking["references"][name], rate_hz)
        refuse_impossible(
            theta_d,
            rate_hz,
            angle_range_deg=self.tracking["angle_range_deg"],
            k_in_kpa_per_deg=self.control["k_in_kpa_per_deg"],
            reservoir_limit_kpa=self.control["reservoir_limit_kpa"],
        )
        return theta_d

    def describe(self, reference: str, name: str, gains: Mapping[str, Any]) -> dict[str, Any]:
        """Return the log attributes of a controller's run, without those of the rig."""
        controller, gain = controller_and_gain(name)
        return {
            "experiment": run_log(reference, name),
            "reference": reference,
            "controller": controller,
            "gain": gain,
            "settle_s": self.tracking["references"][reference]["settle_s"],
            "sample_rate_hz": self.control["sample_rate_hz"],
            "seed": self.seed,
            "software": f"fprc {__version__}",
            "rig": {"control": self.control, "tracking": self.tracking, "gains": gains.get(gain)},
        }

    def pushes(self, samples: int) -> np.ndarray:
        """Return the pushes of the disturbance test, kPa."""
        rng = np.random.default_rng([self.seed, 4711])
        rate_hz = self.control["sample_rate_hz"]
        return random_pushes(samples, rate_hz, rng=rng, **self.tracking["pushes"])

    def law(
        self,
        theta_d: np.ndarray,
        model: SequenceModel | None,
        gains: Mapping[str, float] | None,
    ) -> Law:
        """Return the control law of one controller; the model is reset."""
        if model is not None:
            model.reset()
        period_s = 1.0 / self.control["sample_rate_hz"]
        return tracking_law(
            theta_d,
            k_in_kpa_per_deg=self.control["k_in_kpa_per_deg"],
            pressure_limit_kpa=self.tracking["pressure_limit_kpa"],
            feedforward=None if model is None else feedforward(model),
            feedback=None if gains is None else PD(**gains, period_s=period_s),
        )

    def drive(
        self,
        theta_d: np.ndarray,
        model: SequenceModel | None,
        gains: Mapping[str, float] | None,
        number: int,
        pushes: np.ndarray | None = None,
    ) -> dict[str, np.ndarray]:
        """Run one controller on the rig and return its channels."""
        control, rate_hz = self.control, self.control["sample_rate_hz"]
        period_s = 1.0 / rate_hz
        push = {} if pushes is None else {"push_kpa": _per_tick(pushes)}
        device = SimulatedRig(self.rig, seed=self.seed, run=number, sample_rate_hz=rate_hz, **push)
        return run(
            device,
            device,
            self.law(theta_d, model, gains),
            len(theta_d),
            main_loop=PressurePI(**control["main_loop"], period_s=period_s),
            reservoir_loop=PressurePI(**control["reservoir_loop"], period_s=period_s),
            extra=TRACKING_CHANNELS,
        )

    def precompute(
        self,
        theta_d: np.ndarray,
        models: Mapping[str, SequenceModel],
        number: int,
        pushes: np.ndarray | None = None,
    ) -> dict[str, np.ndarray]:
        """Return P_ff of every model for a whole reference.

        P_o depends on P_i = K_in theta_d only, so one run with the actuator at rest gives it.
        """
        at_rest = self.simulate(theta_d, np.zeros(len(theta_d)), None, number, pushes)
        inputs = np.column_stack([theta_d, at_rest["p_o_kpa"]])
        return {
            name: model.predict(inputs[:, : model.n_features_in_]) for name, model in models.items()
        }

    def simulate(
        self,
        theta_d: np.ndarray,
        p_ff_kpa: np.ndarray,
        gains: Mapping[str, float] | None,
        number: int,
        pushes: np.ndarray | None = None,
    ) -> dict[str, np.ndarray]:
        """Do as ``drive``, in compiled code, with P_ff from ``precompute``."""
        rate_hz = self.control["sample_rate_hz"]
        device = SimulatedRig(self.rig, seed=self.seed, run=number, sample_rate_hz=rate_hz)
        limit_kpa = self.tracking["pressure_limit_kpa"]
        return simulate_tracking(device, self.control, theta_d, p_ff_kpa, gains, limit_kpa, pushes)

    def follow(
        self,
        reference: str,
        name: str,
        model: SequenceModel | None,
        gains: Mapping[str, Any],
    ) -> dict[str, np.ndarray]:
        """Follow a reference with one of the controllers and return its channels.

        Parameters
        ----------
        model : SequenceModel or None
            Gives the feedforward; PD alone does not use it.
        gains : Mapping
            Gains of the PD controller by their name: printed, identified.
        """
        controller, gain = controller_and_gain(name)
        theta_d = self.reference(reference)
        return self.drive(
            theta_d,
            None if controller == "pd" else model,
            gains.get(gain),
            TRACKING_RUNS[reference],
            self.pushes(len(theta_d)) if reference == DISTURBANCE else None,
        )


def tracking_rmse(channels: Mapping[str, np.ndarray], settle_s: float) -> float:
    """Return the RMSE of theta against theta_d after the settling time, deg."""
    judged = channels["time_s"] >= settle_s
    return rmse(channels["theta_d_deg"][judged], channels["theta_deg"][judged])


def bench_gain(bench: Track, model: SequenceModel) -> dict[str, Any]:
    """Return the PD gains by name, and the error of every candidate for the identified one."""
    printed = bench.tracking["printed_gains"]
    theta_d = bench.reference(DISTURBANCE)
    settle_s = bench.tracking["references"][DISTURBANCE]["settle_s"]
    number = TRACKING_RUNS["identification"]
    p_ff_kpa = bench.precompute(theta_d, {"fprc": model}, number)["fprc"]
    tried = []
    for kp in bench.tracking["candidate_kp_kpa_per_deg"]:
        gains = candidate(kp, printed)
        channels = bench.simulate(theta_d, p_ff_kpa, gains, number)
        tried.append({**gains, "rmse_deg": tracking_rmse(channels, settle_s)})
        log.info("kp = %g kPa/deg: %.3f deg", kp, tried[-1]["rmse_deg"])
    return identified(tried, printed) | {"source": "sim", "seed": bench.seed}


def candidate(kp_kpa_per_deg: float, printed: Mapping[str, float]) -> dict[str, float]:
    """Return the gains with this P gain; D keeps its printed ratio to P."""
    ratio_s = printed["kd_kpa_s_per_deg"] / printed["kp_kpa_per_deg"]
    return {"kp_kpa_per_deg": kp_kpa_per_deg, "kd_kpa_s_per_deg": kp_kpa_per_deg * ratio_s}


def identified(tried: list[dict[str, float]], printed: Mapping[str, float]) -> dict[str, Any]:
    """Return the gains by name; the identified ones are the candidate with the least error."""
    best = min(tried, key=lambda entry: entry["rmse_deg"])
    return {
        "printed": dict(printed),
        "identified": {name: best[name] for name in printed},
        "reference": "disturbance, without pushes",
        "candidates": tried,
    }


def measure_control(
    sweep: Data, bench: Track, models: Mapping[str, SequenceModel], controllers: Sequence[str]
) -> dict[str, Any]:
    """Follow every reference with every controller; return what the claims measure.

    Parameters
    ----------
    models : Mapping
        Models that give the feedforward, by name; the gain is identified with FPRC.
    """
    gains = bench_gain(bench, models["fprc"])
    driven_by = {name: feedforward_of(controller_and_gain(name)[0]) for name in controllers}
    driving = {name: models[name] for name in dict.fromkeys(driven_by.values()) if name}
    runs = {}
    for reference, described in bench.tracking["references"].items():
        theta_d, number = bench.reference(reference), TRACKING_RUNS[reference]
        pushes = bench.pushes(len(theta_d)) if reference == DISTURBANCE else None
        p_ff_kpa = bench.precompute(theta_d, driving, number, pushes)
        for name, driver in driven_by.items():
            controller, gain = controller_and_gain(name)
            own = p_ff_kpa[driver] if driver else np.zeros(len(theta_d))
            channels = bench.simulate(theta_d, own, gains.get(gain), number, pushes)
            after = channels["time_s"] >= described["settle_s"]
            run = {channel: values[after] for channel, values in channels.items()}
            runs[f"{reference}/{controller}/{gain}"] = run
        log.info("followed %s with every controller", reference)
    return {
        "gains": {name: gains[name] for name in GAINS},
        "hysteresis": measure_hysteresis(sweep.channels),
        **measure_runs(runs, bench.tracking["pushes"]["quiet_s"]),
    }


def open_loop_errors(bench: Track, model: SequenceModel) -> dict[str, float]:
    """Return the RMSE of the references of Table IV with P_ff of the model alone, deg."""
    errors = {}
    for reference in REFERENCES:
        theta_d, number = bench.reference(reference), TRACKING_RUNS[reference]
        p_ff_kpa = bench.precompute(theta_d, {"own": model}, number)["own"]
        channels = bench.simulate(theta_d, p_ff_kpa, None, number)
        settle_s = bench.tracking["references"][reference]["settle_s"]
        errors[reference] = tracking_rmse(channels, settle_s)
    return errors


def _per_tick(values: np.ndarray) -> Callable[[int], float]:
    listed = values.tolist()
    return lambda tick: listed[min(max(tick, 0), len(listed) - 1)]
