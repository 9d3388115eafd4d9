"""The real rig behind the device protocol: boards, pressure sensors, angle sensors."""

import contextlib
import math
import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from fprc.apparatus.bendlabs import BendSensor, open_bus
from fprc.apparatus.locks import boards_of, locked
from fprc.apparatus.pneumatics import Pressures, Valves, call_all, quietly, vent
from fprc.channels import Readings
from fprc.errors import DeviceError


class HardwareRig:
    """The paper's apparatus (Sec. II-B, Fig. 3).

    Parameters
    ----------
    hardware : Mapping
        As in ``fprc.config.hardware.Hardware``.
    elapsed : callable
        Returns the time since the start of the run, s, which becomes the time of a reading.
    has_lock : bool
        Whether this process already holds the locks of the boards; see ``fprc.apparatus.locks``.
    sleep, now : callable
        Sleep function, and a monotonic clock, s.

    Raises
    ------
    DeviceError
        Lists every part that cannot be opened; the others are released.
    """

    def __init__(
        self,
        hardware: Mapping[str, Any],
        elapsed: Callable[[], float],
        *,
        has_lock: bool = False,
        sleep: Callable[[float], None] = time.sleep,
        now: Callable[[], float] = time.monotonic,
    ):
        self._elapsed = elapsed
        self._voltages = hardware["valves"]
        self._venting: dict[str, Any] = {"sleep": sleep, "now": now}
        self._buses: dict[int, Any] = {}
        self._angles = [math.nan, math.nan]
        problems: dict[str, None] = {}  # each once: both boards may lack the driver
        with contextlib.ExitStack() as opened:
            self._locks = opened.enter_context(contextlib.ExitStack())
            if not has_lock:
                self._locks.enter_context(locked(boards_of(hardware)))

            def attempt(build: Callable[[], Any], release: str) -> Any:
                try:
                    part = build()
                except DeviceError as error:
                    problems[str(error)] = None
                    return None
                opened.callback(quietly, getattr(part, release))
                return part

            def sensor(bus: int, address: int, **calibration: float) -> BendSensor:
                if bus not in self._buses:
                    self._buses[bus] = open_bus(bus)
                    opened.callback(quietly, self._buses[bus].close)
                built = BendSensor(self._buses[bus], address, **calibration)
                built.start(sleep=sleep)
                return built

            self._valves: Valves = attempt(partial(Valves, hardware, reset=True), "close")
            self._inputs: Pressures = attempt(partial(Pressures, hardware), "close")
            self._sensors: list[BendSensor] = [
                attempt(partial(sensor, **hardware[name]), "shutdown")
                for name in ("theta", "phi")
                if hardware[name]
            ]
            if problems:
                raise DeviceError("\n".join(problems))
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
        with self._locks:
            call_all(
                lambda: vent(self._valves, lambda: self._inputs, self._voltages, **self._venting),
                self._valves.release,
                self._inputs.close,
                *(sensor.shutdown for sensor in self._sensors),
                *(bus.close for bus in self._buses.values()),
            )
