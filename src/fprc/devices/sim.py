"""The simulated rig behind the device protocol."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fprc.channels import LEARNING_CHANNELS, RAW_CHANNELS, SENSORS, TRACKING_CHANNELS, Readings
from fprc.control_laws import NEUTRAL_V
from fprc.errors import ControlError, FprcError
from fprc.rig import simulator
from fprc.rig.closed_loop import close_loop

if TYPE_CHECKING:
    from fprc.config.settings import Control
    from fprc.models import Online


class SimulatedRig:
    """Simulated rig and its clock: time advances only in ``wait_for`` and ``follow``.

    Parameters
    ----------
    rig : Mapping
        Parameters, nested as in ``fprc.config.rig.Rig``.
    seed : int
        Seed of the rig, for the calibration errors of its sensors.
    run : int
        Seed of the run, for all noise and drift. Runs with the same ``seed`` are
        experiments on the same rig.
    sample_rate_hz : float
        Ticks per second.

    Attributes
    ----------
    push_kpa : float
        Force that bends the reservoir, as by a hand, while time advances in ``wait_for``; 0.
    """

    def __init__(self, rig: Mapping[str, Any], *, seed: int, run: int, sample_rate_hz: float):
        self.push_kpa = 0.0
        self._period_s = 1.0 / sample_rate_hz
        self._substeps = math.ceil(self._period_s / rig["step_s"] - 1e-9)
        instruments = simulator.draw_instruments(rig, np.random.default_rng([seed]))
        self._rng = np.random.default_rng([seed, run + 1])
        self._state = simulator.initial_state(rig, self._rng)
        self._simulated = self._state, simulator.parameters(rig), instruments
        self._valve_v = np.full(2, NEUTRAL_V)
        self._reading = np.full(1, math.nan, simulator.SAMPLE)
        self._tick = -1
        self._advance(0)

    @property
    def state(self) -> np.ndarray:
        """Copy of the true state, for tests and illustrations."""
        return self._state.copy()

    def wait_for(self, tick: int) -> int:
        """Simulate up to this tick; no tick is ever missed.

        FprcError: the state left its physical range; names the quantity and the time.
        """
        while self._tick < tick:
            self._advance(self._substeps)
        return tick

    def read(self) -> Readings:
        """Return the sensor readings of the current tick."""
        sensors = {name: float(self._reading[name][0]) for name in SENSORS}
        return Readings(self._tick * self._period_s, **sensors)

    def write(self, main_v: float, reservoir_v: float) -> None:
        """Set the voltages of both valves."""
        self._valve_v[:] = main_v, reservoir_v

    def follow(
        self,
        control: "Control",
        p_ff_kpa: np.ndarray,
        theta_d_deg: np.ndarray | None = None,
        pressure_limit_kpa: float = math.inf,
        *,
        feedback: bool = False,
        push_kpa: np.ndarray | None = None,
        online: "Online | None" = None,
        regressors: np.ndarray | None = None,
    ) -> dict[str, np.ndarray]:
        """Run the controllers from the current tick on, in compiled code.

        Returns what ``fprc.control.run`` returns with ``tracking_law``, given P_ff of every sample;
        without a reference, with ``hysteresis_law``: ``p_ff_kpa`` is P_exp, and P_i = K_in theta.

        Parameters
        ----------
        p_ff_kpa, theta_d_deg, push_kpa : ndarrays of shape (n_samples,)
            Feedforward, reference, and push on the reservoir, which is 0 by default.
        pressure_limit_kpa : float, default=inf
            Highest P_d of a run with a reference; the lowest is 0.
        feedback : bool, default=False
            Whether the PD controller acts; without it P_fb = 0.
        online : Online, optional
            The model of the feedforward, if it learns as the run goes on; it is changed.
        regressors : ndarray of shape (n_samples, n_weights), optional
            Those of ``online``.

        Raises
        ------
        ControlError
            P_ff is not finite.
        FprcError
            As ``wait_for``.
        """
        bad = np.flatnonzero(~np.isfinite(p_ff_kpa))
        if bad.size:
            raise ControlError(f"the model gave P_ff = {p_ff_kpa[bad[0]]} kPa at sample {bad[0]}")
        names, samples = RAW_CHANNELS, len(p_ff_kpa)
        limits_kpa, theta_d = (-math.inf, math.inf), np.full(samples, math.nan)
        if theta_d_deg is not None:
            names += TRACKING_CHANNELS
            limits_kpa, theta_d = (0.0, pressure_limit_kpa), theta_d_deg
        chosen = ("kpa_per_deg", "stop_deg", "limit_kpa")
        learning = dict.fromkeys((*chosen, "delay_samples", "mixing"), 0.0)
        learner = np.empty((samples, 0)), np.empty(0), np.empty((0, 0)), np.empty((0, 0))
        if online is not None and regressors is not None:
            names += LEARNING_CHANNELS
            learning = {name: getattr(online.settings, name) for name in chosen}
            learning |= {"delay_samples": online.delay, "mixing": online.mixing}
            learner = regressors, online.learned, online.covariance, online.prior
        settings = control.model_dump(exclude={"feedback"}) | {
            "p_exp_limits_kpa": limits_kpa,
            "acts": feedback,
            "incremental": control.feedback == "incremental",
            "learning": learning,
        }
        pushes = np.zeros(samples) if push_kpa is None else push_kpa
        rows = np.full(samples, math.nan, simulator.SAMPLE)
        setpoints = np.column_stack([p_ff_kpa, theta_d, pushes])
        noise = self._rng.standard_normal((samples - 1, simulator.NOISE_PER_TICK))
        failed, done = close_loop(
            *self._simulated, simulator.record(settings), setpoints, *learner, noise,
            self._period_s, self._substeps, self._tick, self._valve_v, self._reading, rows,
        )  # fmt: skip
        self._tick += done if failed else samples - 1
        self._refuse(failed)
        return {name: rows[name].copy() for name in names}

    def safe(self) -> None:
        """Vent both chambers; closed valves would keep their pressure."""
        self._valve_v[:] = 0.0

    def _advance(self, substeps: int) -> None:
        self._tick += 1
        noise = self._rng.standard_normal(simulator.NOISE_PER_TICK)
        failed = simulator.advance(
            *self._simulated, self._valve_v, self.push_kpa, noise, self._period_s, substeps,
            self._reading,
        )  # fmt: skip
        self._refuse(failed)

    def _refuse(self, failed: int) -> None:
        if failed:
            raise FprcError(
                f"simulated rig: the {simulator.DIVERGED[failed]} left its physical range at "
                f"t = {self._tick * self._period_s:.3f} s; check the gains under control and "
                "the parameters under rig, or reduce rig.step_s"
            )
