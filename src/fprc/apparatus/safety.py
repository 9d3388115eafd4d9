"""Safety limits of a real rig: a wrapper that stops the run when one is exceeded."""

import math
from collections.abc import Mapping
from typing import Any

from fprc.channels import SENSORS, Readings, unit_of
from fprc.control_laws import HIGHEST_V
from fprc.devices import Device
from fprc.errors import SafetyError


class CheckedRig:
    """A rig whose readings and commands are checked at every sample.

    A reading stops the run if it is not finite, is out of range, jumps further
    than the rig can move between two samples, or stays constant for too long
    (a working sensor has noise).

    ``limits`` are as in ``fprc.config.hardware.Limits``. Those on jumps are per period: after a
    missed tick a reading may change by more.
    """

    def __init__(
        self, device: Device, limits: Mapping[str, Any], period_s: float, *, phi: bool = True
    ):
        self._device, self.safe = device, device.safe
        self._period_s, self._stale_s = period_s, limits["stale_s"]
        steps = {"kPa": limits["pressure_step_kpa"], "deg": limits["angle_step_deg"]}
        self._watched = [
            (name, *limits[name], steps[unit_of(name)])
            for name in SENSORS
            if name in limits and (phi or name != "phi_deg")
        ]
        self._last: Readings | None = None
        self._changed_s: dict[str, float] = {}

    def read(self) -> Readings:
        """Return the readings; SafetyError lists each beyond its limits, with the limit's key."""
        now = self._device.read()
        last, self._last = self._last or now, now
        periods = max((now.time_s - last.time_s) / self._period_s, 1.0)
        problems = []
        for name, low, high, step in self._watched:
            value, before = getattr(now, name), getattr(last, name)
            if not math.isfinite(value):
                problems.append(f"{name}: no reading; check the sensor's cable")
                continue
            if not low <= value <= high:
                problems.append(
                    f"{name} = {value:.1f} is outside {low:g} to {high:g} (hardware.limits.{name})"
                    "; if that is not true, check the sensor's cable, channel and calibration"
                )
            if abs(value - before) > step * periods:
                problems.append(
                    f"{name} jumped from {before:.1f} to {value:.1f} in {periods:.1f} samples, "
                    f"more than {step:g} per sample; check sensor and cable, or hardware.limits"
                )
            if value != before or name not in self._changed_s:
                self._changed_s[name] = now.time_s
            elif (held_s := now.time_s - self._changed_s[name]) > self._stale_s:
                problems.append(
                    f"{name} has been {value:g} for {held_s:.2f} s; the sensor is frozen or "
                    "disconnected (hardware.limits.stale_s)"
                )
        if problems:
            raise SafetyError("\n".join(problems))
        return now

    def write(self, main_v: float, reservoir_v: float) -> None:
        """Set the voltages of both valves; SafetyError, before any is written: not 0 to 10 V."""
        for name, volts in (("actuator", main_v), ("reservoir", reservoir_v)):
            if not 0.0 <= volts <= HIGHEST_V:
                raise SafetyError(f"valve of the {name}: {volts} V is outside 0 to {HIGHEST_V:g} V")
        self._device.write(main_v, reservoir_v)
