"""The simulated rig behind the device protocol."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from fprc.channels import CHANNELS, Readings
from fprc.control_laws import NEUTRAL_V
from fprc.errors import SimulationError
from fprc.rig.closed_loop import RECORDED, close_loop
from fprc.rig.parameters import record
from fprc.rig.simulator import (
    DIVERGED,
    NOISE_PER_TICK,
    advance,
    draw_instruments,
    initial_state,
    parameters,
)

_NOISE_BLOCK = 4096

#: Of a feedforward that does not learn.
_NO_LEARNER = (np.empty((0, 0)), np.empty(0), np.empty((0, 0)), np.empty((0, 0)))


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
    push_kpa : callable, optional
        Force that bends the reservoir, as by a hand, in kPa, as a function of the
        tick; none by default.
    """

    def __init__(
        self,
        rig: Mapping[str, Any],
        *,
        seed: int,
        run: int,
        sample_rate_hz: float,
        push_kpa: Callable[[int], float] = lambda tick: 0.0,
    ):
        self._push_kpa = push_kpa
        self._period_s = 1.0 / sample_rate_hz
        self._substeps = math.ceil(self._period_s / rig["step_s"] - 1e-9)
        self._rig = parameters(rig)
        self._instruments = draw_instruments(rig, np.random.default_rng([seed]))
        self._rng = np.random.default_rng([seed, run + 1])
        self._state = initial_state(rig, self._rng)
        self._valve_v = np.full(2, NEUTRAL_V)
        self._reading = np.zeros(5)
        self._noise = np.empty((0, NOISE_PER_TICK))
        self._used = 0  # rows of _noise
        self._tick = -1
        sensor = rig["pressure_sensor"]
        self._zero_v = sensor["zero_v"]
        self._kpa_per_v = sensor["full_scale_kpa"] / sensor["span_v"]
        self._advance(0)

    @property
    def state(self) -> np.ndarray:
        """Copy of the true state, for tests and illustrations."""
        return self._state.copy()

    def wait_for(self, tick: int) -> int:
        """Simulate up to this tick; no tick is ever missed.

        Raises
        ------
        SimulationError
            The state left its physical range; names the quantity and the time.
        """
        while self._tick < tick:
            self._advance(self._substeps)
        return tick

    def read(self) -> Readings:
        """Return the sensor readings of the current tick."""
        *volts, theta, phi = self._reading.tolist()
        p_exp, p_i, p_o = ((v - self._zero_v) * self._kpa_per_v for v in volts)
        return Readings(self._tick * self._period_s, p_exp, theta, p_i, p_o, phi)

    def write(self, main_v: float, reservoir_v: float) -> None:
        """Set the voltages of both valves."""
        self._valve_v[:] = main_v, reservoir_v

    def follow(
        self,
        controllers: Mapping[str, Any],
        setpoints: np.ndarray,
        learner: tuple[np.ndarray, ...] = _NO_LEARNER,
    ) -> dict[str, np.ndarray]:
        """Run the controllers from the current tick on, in compiled code.

        The result is that of a loop over ``wait_for``, ``read`` and ``write``.

        Parameters
        ----------
        controllers : Mapping
            See ``fprc.rig.closed_loop.close_loop``.
        setpoints : ndarray of shape (n_samples, 4)
            See ``fprc.rig.closed_loop.close_loop``.
        learner : tuple of ndarray, optional
            ``regressors``, ``learned``, ``covariance`` and ``prior`` of ``close_loop``.

        Returns
        -------
        dict of ndarray
            One array for each of ``fprc.channels.CHANNELS``.

        Raises
        ------
        SimulationError
            The state left its physical range; names the quantity and the time.
        """
        samples = len(setpoints)
        rows = np.full(samples, math.nan, RECORDED)
        failed, done = close_loop(
            self._state,
            self._rig,
            self._instruments,
            record(controllers),
            setpoints,
            *learner,
            self._next_noise(samples - 1),
            self._period_s,
            self._substeps,
            self._tick,
            self._valve_v,
            self._reading,
            rows,
        )
        self._tick += done if failed else samples - 1
        self._refuse(failed)
        return {channel.name: rows[channel.name].copy() for channel in CHANNELS}

    def safe(self) -> None:
        """Vent both chambers; closed valves would keep their pressure."""
        self._valve_v[:] = 0.0

    def _advance(self, substeps: int) -> None:
        self._tick += 1
        failed = advance(
            self._state,
            self._rig,
            self._instruments,
            self._valve_v,
            self._push_kpa(self._tick),
            self._next_noise(1)[0],
            self._period_s,
            substeps,
            self._reading,
        )
        self._refuse(failed)

    def _next_noise(self, ticks: int) -> np.ndarray:
        missing = self._used + ticks - len(self._noise)
        if missing > 0:
            rows = math.ceil(missing / _NOISE_BLOCK) * _NOISE_BLOCK
            noise = self._rng.standard_normal((rows, NOISE_PER_TICK))
            self._used, self._noise = 0, np.concatenate([self._noise[self._used :], noise])
        self._used += ticks
        return self._noise[self._used - ticks : self._used]

    def _refuse(self, failed: int) -> None:
        if failed:
            raise SimulationError(
                f"simulated rig: the {DIVERGED[failed]} left its physical range at "
                f"t = {self._tick * self._period_s:.3f} s; check the gains under control and "
                "the parameters under rig, or reduce rig.step_s"
            )
