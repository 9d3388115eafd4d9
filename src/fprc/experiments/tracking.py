"""Closed-loop runs of Sec. IV: feedforward, feedback, and both."""

import logging
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from fprc import __version__
from fprc.artifacts import read_json, write_json
from fprc.control import (
    PD,
    TRACKING_CHANNELS,
    Law,
    PressurePI,
    RunAbortedError,
    refuse_impossible,
    run,
    tracking_law,
)
from fprc.devices import Readings, SimulatedRig
from fprc.errors import LogError
from fprc.evaluation import rmse
from fprc.logs import read_run, write_raw
from fprc.logs.isolated import isolated_each
from fprc.models import SequenceModel, load_model
from fprc.signals import random_pushes, reference_angle
from fprc.stages.gains import gains_told

log = logging.getLogger(__name__)

#: Controller and gain of each run, by the name that its file has.
CONTROLLERS = {
    "fprc": ("fprc", "none"),
    "fprc_pd_printed": ("fprc_pd", "printed"),
    "fprc_pd_identified": ("fprc_pd", "identified"),
    "pd_printed": ("pd", "printed"),
    "pd_identified": ("pd", "identified"),
}

#: Number of the runs on the rig; with the seed it decides the noise. All controllers meet the
#: same noise and drift on a reference, so that they differ by what they do alone.
_RUNS = {
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
        """Return theta_d, refused if the rig could not follow it."""
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
        """Return what the log of a controller's run says of it, but for the rig."""
        controller, gain = CONTROLLERS[name]
        return {
            "experiment": f"track_{reference}_{name}",
            "reference": reference,
            "controller": controller,
            "gain": gain,
            "settle_s": self.tracking["references"][reference]["settle_s"],
            "sample_rate_hz": self.control["sample_rate_hz"],
            "seed": self.seed,
            "software": f"fprc {__version__}",
            "rig": {
                "control": self.control,
                "tracking": self.tracking,
                "gains": gains.get(gain),
            },
        }

    def pushes(self, samples: int) -> np.ndarray:
        """Return the forces of the disturbance test."""
        rng = np.random.default_rng([self.seed, 4711])
        rate_hz = self.control["sample_rate_hz"]
        return random_pushes(samples, rate_hz, rng=rng, **self.tracking["pushes"])

    def law(
        self,
        theta_d: np.ndarray,
        model: SequenceModel | None,
        gains: Mapping[str, float] | None,
    ) -> Law:
        """Return the law of one controller; a model begins from rest."""
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
        control = self.control
        period_s = 1.0 / control["sample_rate_hz"]
        push = {} if pushes is None else {"push_kpa": _held(pushes)}
        device = SimulatedRig(
            self.rig,
            seed=self.seed,
            run=number,
            sample_rate_hz=control["sample_rate_hz"],
            **push,
        )
        return run(
            device,
            device,
            self.law(theta_d, model, gains),
            len(theta_d),
            main_loop=PressurePI(**control["main_loop"], period_s=period_s),
            reservoir_loop=PressurePI(**control["reservoir_loop"], period_s=period_s),
            extra=TRACKING_CHANNELS,
        )

    def follow(
        self,
        reference: str,
        name: str,
        model: SequenceModel,
        gains: Mapping[str, Any],
    ) -> dict[str, np.ndarray]:
        """Follow a reference with one of the controllers and return its channels.

        Parameters
        ----------
        gains : Mapping
            Gains of the PD controller by their name: printed, identified.
        """
        controller, gain = CONTROLLERS[name]
        theta_d = self.reference(reference)
        return self.drive(
            theta_d,
            None if controller == "pd" else model,
            gains.get(gain),
            _RUNS[reference],
            self.pushes(len(theta_d)) if reference == "disturbance" else None,
        )


def tracking_error(channels: Mapping[str, np.ndarray], settle_s: float) -> np.ndarray:
    """theta_d - theta after the settling time, deg."""
    judged = channels["time_s"] >= settle_s
    return (channels["theta_d_deg"] - channels["theta_deg"])[judged]


def identify_gain(
    model: str,
    gains: str,
    *,
    tracking: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    seed: int,
) -> None:
    """Find the P gain with the least error on a reference outside Table IV.

    The D gain keeps its printed ratio to the P gain.
    """
    bench = Track(tracking, control, rig, seed)
    write_json(gains, bench_gain(bench, load_model(model)))


def bench_gain(bench: Track, model: SequenceModel) -> dict[str, Any]:
    """Return the identified gains and the error of every candidate."""
    printed = bench.tracking["printed_gains"]
    theta_d = bench.reference("disturbance")
    settle_s = bench.tracking["references"]["disturbance"]["settle_s"]
    tried = []
    for kp in bench.tracking["candidate_kp_kpa_per_deg"]:
        gains = candidate(kp, printed)
        channels = bench.drive(theta_d, model, gains, _RUNS["identification"])
        error = tracking_error(channels, settle_s)
        tried.append({**gains, "rmse_deg": rmse(error, np.zeros_like(error))})
        log.info("kp = %g kPa/deg: %.3f deg", kp, tried[-1]["rmse_deg"])
    return _identified(tried, printed) | {"source": "sim", "seed": bench.seed}


def identify_gain_from_logs(raw: Sequence[str], gains: str, *, tracking: Mapping[str, Any]) -> None:
    """Find the P gain with the least error in the logs of a real rig, one for each candidate."""
    tried = []
    names = ("time_s", "theta_d_deg", "theta_deg")
    for found in isolated_each(read_run, raw, names=names):
        error = tracking_error(found.channels, found.attributes["settle_s"])
        given = gains_told(found.attributes)
        if given is None:
            raise LogError(f"{found.path}: attribute rig: names no gains; record the log again")
        tried.append({**given, "rmse_deg": rmse(error, np.zeros_like(error))})
    found = _identified(tried, tracking["printed_gains"])
    write_json(gains, found | {"source": "rig"})


def candidate(kp_kpa_per_deg: float, printed: Mapping[str, float]) -> dict[str, float]:
    """Return the gains with this P gain; D keeps its printed ratio to P."""
    ratio_s = printed["kd_kpa_s_per_deg"] / printed["kp_kpa_per_deg"]
    return {"kp_kpa_per_deg": kp_kpa_per_deg, "kd_kpa_s_per_deg": kp_kpa_per_deg * ratio_s}


def _identified(tried: list[dict[str, float]], printed: Mapping[str, float]) -> dict[str, Any]:
    best = min(tried, key=lambda entry: entry["rmse_deg"])
    return {
        "printed": dict(printed),
        "identified": {name: best[name] for name in printed},
        "reference": "disturbance, without pushes",
        "candidates": tried,
    }


def track(
    model: str,
    gains: str,
    raw: Sequence[str],
    *,
    reference: str,
    controllers: Sequence[str],
    tracking: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    seed: int,
) -> None:
    """Follow one reference with every controller; one raw log each.

    Raises
    ------
    ControlError
        The reference is impossible, or a run was stopped; what it recorded
        is then kept beside the log as ``*.aborted.h5``.
    """
    bench = Track(tracking, control, rig, seed)
    fitted = load_model(model)
    known_gains = read_json(gains)
    for path, name in zip(raw, controllers, strict=True):
        described = bench.describe(reference, name, known_gains)
        described |= {"source": "sim", "rig": {"rig": rig, **described["rig"]}}
        try:
            channels = bench.follow(reference, name, fitted, known_gains)
        except RunAbortedError as stopped:
            rescued = f"{path.removesuffix('.h5')}.aborted.h5"
            write_raw(rescued, stopped.channels, **described, aborted=str(stopped))
            log.error("kept what was recorded in %s", rescued)
            raise
        write_raw(path, channels, **described)
        error = tracking_error(channels, described["settle_s"])
        log.info("%s: RMSE %.3f deg", name, rmse(error, np.zeros_like(error)))


def feedforward(model: SequenceModel) -> Callable[[float, Readings], float]:
    """Return the model as what a tracking law asks for P_ff."""
    if model.n_features_in_ == 1:
        return lambda theta_d, now: model.step((theta_d,))
    return lambda theta_d, now: model.step((theta_d, now.p_o_kpa))


def _held(values: np.ndarray):
    listed = values.tolist()
    return lambda tick: listed[min(max(tick, 0), len(listed) - 1)]
