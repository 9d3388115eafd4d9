"""The simulated rig behind the device protocol."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from fprc.devices.protocol import NEUTRAL_V, Readings
from fprc.errors import SimulationError
from fprc.rig.parameters import record
from fprc.rig.simulator import (
    DIVERGED,
    NOISE_PER_TICK,
    advance,
    draw_instruments,
    initial_state,
)

_NOISE_BLOCK = 4096


class SimulatedRig:
    """Simulated rig and its clock: time advances only in ``wait_for`` and ``wait_until``.

    Parameters
    ----------
    rig : Mapping
        Parameters, nested as in ``fprc.config.rig.Rig``.
    seed : int
        Seed of the rig: draws the calibration errors of its sensors.
    run : int
        Seed of the run: draws all noise and drift. Two runs with the same ``seed``
        are two experiments on the same rig.
    sample_rate_hz : float
        Ticks per second.
    push_kpa : callable, optional
        External push on the reservoir's bending, as by a hand, as a function of
        the tick; none by default.
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
        self._rig = record(rig)
        self._instruments = draw_instruments(rig, np.random.default_rng([seed]))
        self._rng = np.random.default_rng([seed, run + 1])
        self._state = initial_state(rig, self._rng)
        self._valve_v = np.full(2, NEUTRAL_V)
        self._reading = np.zeros(5)
        self._noise = np.empty((0, NOISE_PER_TICK))
        self._tick = -1
        sensor = rig["pressure_sensor"]
        self._zero_v = sensor["zero_v"]
        self._kpa_per_v = sensor["full_scale_kpa"] / sensor["span_v"]
        self._advance(0)

    @property
    def state(self) -> np.ndarray:
        """Copy of the true state, for tests and illustrations."""
        return self._state.copy()

    def wait_until(self, time_s: float) -> None:
        """Simulate up to the tick nearest to ``time_s``.

        Raises
        ------
        SimulationError
            The state left its physical range; names the quantity and the time.
        """
        self.wait_for(round(time_s / self._period_s))

    def wait_for(self, tick: int) -> int:
        """Simulate up to this tick; no tick is ever missed."""
        while self._tick < tick:
            self._advance(self._substeps)
        return tick

    def read(self) -> Readings:
        """Return the sensor readings of the current tick."""
        p_exp, p_i, p_o, theta, phi = self._reading.tolist()
        zero, gain = self._zero_v, self._kpa_per_v
        return Readings(
            self._tick * self._period_s,
            (p_exp - zero) * gain,
            theta,
            (p_i - zero) * gain,
            (p_o - zero) * gain,
            phi,
        )

    def write(self, main_v: float, reservoir_v: float) -> None:
        """Set the voltages of both valves."""
        self._valve_v[0] = main_v
        self._valve_v[1] = reservoir_v

    def safe(self) -> None:
        """Vent both chambers; a valve in neutral would keep their pressure."""
        self._valve_v[:] = 0.0

    def close(self) -> None:
        """Make safe; nothing to release."""
        self.safe()

    def _advance(self, substeps: int) -> None:
        self._tick += 1
        row = self._tick % _NOISE_BLOCK
        if row == 0:
            self._noise = self._rng.standard_normal((_NOISE_BLOCK, NOISE_PER_TICK))
        failed = advance(
            self._state,
            self._rig,
            self._instruments,
            self._valve_v,
            self._push_kpa(self._tick),
            self._noise[row],
            self._period_s,
            substeps,
            self._reading,
        )
        if failed:
            raise SimulationError(
                f"simulated rig: the {DIVERGED[failed]} left its physical range at "
                f"t = {self._tick * self._period_s:.3f} s; check the gains under control and "
                "the parameters under rig, or reduce rig.step_s"
            )
