"""The real rig behind the device protocol: boards, pressure sensors, angle sensors."""

import contextlib
import math
import time
from collections.abc import Callable, Mapping
from typing import Any

from fprc.apparatus.bendlabs import BendSensor, open_bus
from fprc.apparatus.pneumatics import Pressures, Valves, call_all, quietly, vent
from fprc.channels import Readings


class HardwareRig:
    """The paper's apparatus (Sec. II-B, Fig. 3).

    The caller holds the locks of the boards, see ``fprc.apparatus.contec``.

    Parameters
    ----------
    hardware : Mapping
        As in ``fprc.config.hardware.Hardware``.
    elapsed : callable
        Returns the time since the start of the run, s, which becomes the time of a reading.
    sleep, now : callable
        Sleep function, and a monotonic clock, s.

    Raises
    ------
    DeviceError
        A part cannot be opened; the others are released, vented.
    """

    def __init__(
        self,
        hardware: Mapping[str, Any],
        elapsed: Callable[[], float],
        *,
        sleep: Callable[[float], None] = time.sleep,
        now: Callable[[], float] = time.monotonic,
    ):
        self._elapsed, self._voltages = elapsed, hardware["valves"]
        self._venting: dict[str, Any] = {"sleep": sleep, "now": now}
        self._buses: dict[int, Any] = {}
        self._sensors: list[BendSensor] = []
        self._angles = [math.nan, math.nan]
        with contextlib.ExitStack() as opened:
            self._valves = Valves(hardware, reset=True)
            opened.callback(quietly, self._valves.close)
            self._inputs = Pressures(hardware)
            opened.callback(quietly, self._inputs.close)
            for place in filter(None, (hardware["theta"], hardware["phi"])):
                calibration = dict(place)
                number = calibration.pop("bus")
                if number not in self._buses:
                    self._buses[number] = open_bus(number)
                    opened.callback(quietly, self._buses[number].close)
                self._sensors.append(BendSensor(self._buses[number], **calibration))
                opened.callback(quietly, self._sensors[-1].shutdown)
                self._sensors[-1].start(sleep=sleep)
            opened.pop_all()
        self.write, self.safe = self._valves.write, self._valves.vent

    def read(self) -> Readings:
        """Return the latest reading of every sensor; NaN for a sensor that the rig lacks.

        Raises
        ------
        DeviceError
            A board or a sensor does not answer.
        """
        stamp = self._elapsed()
        p_exp, p_i, p_o = self._inputs.read()
        for k, sensor in enumerate(self._sensors):
            angle = sensor.read()
            if angle is not None:
                self._angles[k] = angle
        return Readings(stamp, p_exp, self._angles[0], p_i, p_o, self._angles[1])

    def close(self) -> None:
        """Vent, wait until readings confirm it, and release every part, even if a step fails.

        Raises
        ------
        DeviceError
            No reading confirms that both chambers are vented; the driver or a sensor reports
            an error.
        """
        call_all(
            lambda: vent(self._valves, lambda: self._inputs, self._voltages, **self._venting),
            self._valves.release,
            self._inputs.close,
            *(sensor.shutdown for sensor in self._sensors),
            *(bus.close for bus in self._buses.values()),
        )
