"""The real rig behind the device protocol: valves, pressure sensors, angle sensors, and venting.

``hardware`` is a mapping as in ``fprc.config.hardware.Hardware``. Whoever opens a part of it holds
the locks of the boards, see ``fprc.apparatus.contec``.
"""

import math
import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack, suppress
from functools import partial
from itertools import cycle
from typing import Any

from fprc.apparatus.bendlabs import BendSensor, open_bus
from fprc.apparatus.contec import Board, locked
from fprc.channels import Readings
from fprc.errors import DeviceError

#: Time between two readings while a chamber vents, s.
_POLL_S = 0.02
#: Consecutive readings that must show a vented chamber.
_IN_A_ROW = 10


class NotVentedError(DeviceError):
    """No reading confirms that the chambers are vented."""

    def __init__(self, why: str):
        super().__init__(
            f"THE CHAMBERS MAY BE UNDER PRESSURE: {why}. Cut the supply and open the chambers by "
            "hand; if a gauge shows 0 kPa, check the sensors' cables and zero_v"
        )


class Pneumatics:
    """Both proportional valves, the three pressure sensors, and the optional heartbeat output.

    With ``reset`` both boards are reset, and both chambers are vented; without, the output board is
    opened as it is, and the input board when it is read. Each method raises DeviceError if the
    driver reports an error, after trying its other writes.
    """

    def __init__(self, hardware: Mapping[str, Any], *, reset: bool):
        boards, self._voltages = hardware["boards"], hardware["valves"]
        self._sensors = [(boards[f"{k}_input"], hardware[k]) for k in ("p_exp", "p_i", "p_o")]
        self._outputs = boards["main_output"], boards["reservoir_output"]
        # for a watchdog relay
        self._heartbeat, self._beat_v = boards["heartbeat_output"], cycle((5.0, 0.0))
        self._open_inputs = partial(Board, boards["library"], boards["input_device"], "Ai")
        self._inputs: Board | None = None
        self._board = Board(boards["library"], boards["output_device"], "Ao", reset=reset)
        if reset:
            try:
                self.exhaust()  # even at rest: a closed valve leaks, and would fill the chamber
                self._inputs = self._open_inputs()
            except BaseException:
                with suppress(DeviceError):
                    self.close()  # tries to vent once more
                raise

    def pressures(self) -> list[float]:
        """Return the present P_exp, P_i and P_o, kPa gauge."""
        self._inputs = self._inputs or self._open_inputs()
        volts = self._inputs.read(1 + max(channel for channel, _ in self._sensors))
        return [(volts[at] - own["zero_v"]) * own["gain_kpa_per_v"] for at, own in self._sensors]

    def write(self, main_v: float, reservoir_v: float) -> None:
        """Set both voltages; if both writes succeed, toggle the heartbeat output."""
        self._write_in_turn(main_v, reservoir_v)
        if self._heartbeat is not None:
            self._board.write(self._heartbeat, next(self._beat_v))

    def safe(self) -> None:
        """Close both valves, then open both chambers to the atmosphere."""
        self._write_in_turn(*2 * [self._voltages["neutral_v"]], *2 * [self._voltages["vent_v"]])

    def exhaust(self) -> None:
        """Open both chambers to the atmosphere at once."""
        self._write_in_turn(*2 * [self._voltages["vent_v"]])

    def release(self) -> None:
        """Release the boards; the outputs hold their voltages."""
        _call_all(board.close for board in (self._board, self._inputs) if board)

    def close(self) -> None:
        """Open both chambers to the atmosphere at once, and release the boards."""
        _call_all([self.exhaust, self.release])

    def _write_in_turn(self, *volts: float) -> None:
        """Write voltages to the actuator's and the reservoir's valve in turn."""
        writes = zip(cycle(self._outputs), volts)
        _call_all(partial(self._board.write, *write) for write in writes)

    def vent(
        self,
        sleep: Callable[[float], None] = time.sleep,
        now: Callable[[], float] = time.monotonic,
        note: Callable[[str], None] = lambda text: None,
    ) -> None:
        """Set both valves to vent, repeatedly, until readings show that both chambers are vented.

        A chamber is vented if its sensor has read ``vented_kpa`` or less ten times in a row and has
        changed since the first reading: a frozen one proves nothing. The valves are written again
        before each reading, because the board may fail for a moment; ``note`` gets each success.

        NotVentedError: ``vent_s`` after the first successful write, no reading shows that both
        chambers are vented. DeviceError: every write has failed for ``vent_s``.
        """
        began_s, longest_s = now(), self._voltages["vent_s"]
        limit_kpa = self._voltages["vented_kpa"]
        written_s: float | None = None
        seen: list[list[float]] = []
        in_a_row = 0
        while True:
            failed = ""
            try:
                self.exhaust()
                written_s = now() if written_s is None else written_s
                note("the valves took the voltage to vent, but no reading shows it yet")
            except DeviceError as error:
                failed = f"{error}; "
                if written_s is None and now() - began_s > longest_s:
                    raise
            try:
                seen.append(self.pressures()[:2])
                # abs: a disconnected sensor reads far below 0
                in_a_row = in_a_row + 1 if all(abs(kpa) <= limit_kpa for kpa in seen[-1]) else 0
                state = "p_exp_kpa = {:.1f}, p_i_kpa = {:.1f}".format(*seen[-1])
            except DeviceError as error:
                in_a_row, state = 0, f"no pressure can be read ({error})"
            frozen = any(len(set(values)) == 1 for values in zip(*seen, strict=True))
            if written_s is not None:
                if in_a_row >= _IN_A_ROW and not frozen:
                    return
                if now() - written_s > longest_s:
                    state += ", a frozen sensor" if frozen else ""
                    raise NotVentedError(
                        f"after {longest_s:g} s at vent, {failed}{state}; vented is {limit_kpa:g} "
                        "or less (valves.vented_kpa)"
                    )
            sleep(_POLL_S)


def vent_from_outside(hardware: Mapping[str, Any], note: Callable[[str], None]) -> None:
    """Vent both chambers after another process has driven them; as ``vent``."""
    pneumatics = Pneumatics(hardware, reset=False)
    try:
        pneumatics.vent(note=note)
    finally:
        with suppress(DeviceError):
            pneumatics.close()


class HardwareRig:
    """The paper's apparatus (Sec. II-B, Fig. 3).

    ``elapsed`` returns the time since the start of the run, s, which becomes the time of a reading;
    ``sleep`` and ``now`` are a sleep function and a monotonic clock, s. Unless this process
    ``has_lock`` of the boards already, it takes the locks until ``close``. DeviceError: another
    process has a board, and nothing was moved; or a part cannot be opened, and the others are
    released, vented.
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
        self._elapsed, self._buses = elapsed, dict[int, Any]()
        self._sensors, self._angles = list[BendSensor](), [math.nan, math.nan]
        with ExitStack() as locks:
            if not has_lock:
                locks.enter_context(locked(hardware))
            self._pneumatics = Pneumatics(hardware, reset=True)
            self._locks = locks.pop_all()
        self._vent = partial(self._pneumatics.vent, sleep=sleep, now=now)
        self.write, self.safe = self._pneumatics.write, self._pneumatics.safe
        try:
            for place in filter(None, (hardware["theta"], hardware["phi"])):
                calibration = dict(place)
                number = calibration.pop("bus")
                if number not in self._buses:
                    self._buses[number] = open_bus(number)
                self._sensors.append(BendSensor(self._buses[number], **calibration))
                self._sensors[-1].start(sleep=sleep)
        except BaseException:
            with suppress(DeviceError):
                self._end(self._pneumatics.exhaust)
            raise

    def read(self) -> Readings:
        """Return the latest reading of every sensor; NaN for a sensor that the rig lacks.

        DeviceError: a board or a sensor does not answer.
        """
        stamp = self._elapsed()
        p_exp, p_i, p_o = self._pneumatics.pressures()
        for k, sensor in enumerate(self._sensors):
            angle = sensor.read()
            if angle is not None:
                self._angles[k] = angle
        return Readings(stamp, p_exp, self._angles[0], p_i, p_o, self._angles[1])

    def close(self) -> None:
        """Vent, wait until readings confirm it, and release every part, even if a step fails.

        DeviceError: no reading confirms that both chambers are vented, or a part reports an error.
        """
        self._end(self._vent)

    def _end(self, vent: Callable[[], None]) -> None:
        sensors = (sensor.shutdown for sensor in self._sensors)
        buses = (bus.close for bus in self._buses.values())
        with self._locks:
            _call_all([vent, self._pneumatics.release, *sensors, *buses])


def _call_all(calls: Iterable[Callable[[], None]]) -> None:
    """Make every call, then raise all their errors together."""
    problems = []
    for call in calls:
        try:
            call()
        except (DeviceError, OSError) as error:
            problems.append(str(error))
    if problems:
        raise DeviceError("\n".join(dict.fromkeys(problems)))
