"""Safety limits of a real rig: a wrapper that stops the run when one is exceeded."""

from collections.abc import Mapping
from typing import Any

from fprc.channels import SENSORS, Readings, unit_of
from fprc.control_laws import HIGHEST_V
from fprc.devices import Device
from fprc.errors import SafetyError


class CheckedRig:
    """A rig whose readings and commands are checked at every sample.

    A reading stops the run if it is no number, is out of range, jumps further than the rig can
    move between two samples, or stays constant for too long (a working sensor has noise).

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
            if not low <= value <= high:  # NaN too
                problems.append(f"{name} = {value:.1f} is outside {low:g} to {high:g} ({name})")
            if abs(value - before) > step * periods:
                problems.append(
                    f"{name} jumped from {before:.1f} to {value:.1f} in {periods:.1f} samples, "
                    f"more than {step:g} per sample (pressure_step_kpa, angle_step_deg)"
                )
            if value != before or name not in self._changed_s:
                self._changed_s[name] = now.time_s
            elif (held_s := now.time_s - self._changed_s[name]) > self._stale_s:
                problems.append(f"{name} has been {value:g} for {held_s:.2f} s (stale_s)")
        if problems:
            raise SafetyError(
                "; ".join(problems) + "; check the sensor's cable, channel and calibration, and "
                "hardware.limits"
            )
        return now

    def write(self, main_v: float, reservoir_v: float) -> None:
        """Set the voltages of both valves; SafetyError, before any is written: not 0 to 10 V."""
        if not (0.0 <= main_v <= HIGHEST_V and 0.0 <= reservoir_v <= HIGHEST_V):
            raise SafetyError(f"a valve takes 0 to {HIGHEST_V:g} V, not {main_v} and {reservoir_v}")
        self._device.write(main_v, reservoir_v)
