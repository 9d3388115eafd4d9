"""The real rig behind the device protocol: valves, pressure sensors, angle sensors, and venting.

``hardware`` is a mapping as in ``fprc.config.hardware.Hardware``. Whoever opens a part of it holds
the locks of the boards, see ``fprc.apparatus.contec``.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, ExitStack, suppress
from functools import partial
from itertools import cycle
from typing import Any

from fprc.apparatus.bendlabs import BendSensor
from fprc.apparatus.contec import Board
from fprc.channels import Readings
from fprc.errors import DeviceError

#: Time to wait between two readings while a chamber vents, s.
POLL_S = 0.02
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

    The input board is opened when it is first read; without ``reset`` the outputs hold their
    voltages until then. Each method raises DeviceError if the driver reports an error, after trying
    its other writes.
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

    def _write_in_turn(self, *volts: float) -> None:
        """Write voltages to the actuator's and the reservoir's valve in turn."""
        writes = zip(cycle(self._outputs), volts)
        _call_all(partial(self._board.write, *write) for write in writes)

    def vent(self) -> Iterator[str]:
        """Set both valves to vent, repeatedly, until readings show that both chambers are vented.

        Before each reading it yields what is known, and the caller waits for ``POLL_S``. A chamber
        is vented if its sensor has read ``vented_kpa`` or less ten times in a row and has changed
        since the first reading: a frozen one proves nothing. The valves are written again before
        each reading, because the board may fail for a moment.

        NotVentedError: ``vent_s`` after the first successful write, no reading shows that both
        chambers are vented. DeviceError: every write has failed for ``vent_s``.
        """
        began_s, longest_s = time.monotonic(), self._voltages["vent_s"]
        limit_kpa = self._voltages["vented_kpa"]
        written_s: float | None = None
        seen: list[list[float]] = []
        in_a_row = 0
        while True:
            failed, known = "", "the valves took the voltage to vent, but no reading shows it yet"
            try:
                self.exhaust()
                written_s = time.monotonic() if written_s is None else written_s
            except DeviceError as error:
                failed, known = f"{error}; ", str(error)
                if written_s is None and time.monotonic() - began_s > longest_s:
                    raise
            yield known
            try:
                seen.append(self.pressures()[:2])
                # abs: a disconnected sensor reads far below 0
                in_a_row = in_a_row + 1 if all(abs(kpa) <= limit_kpa for kpa in seen[-1]) else 0
                state = "p_exp_kpa = {:.1f}, p_i_kpa = {:.1f}".format(*seen[-1])
            except DeviceError as error:
                in_a_row, state = 0, f"no pressure can be read ({error})"
            frozen = any(len(set(values)) == 1 for values in zip(*seen, strict=True))
            if written_s is None:
                continue
            if in_a_row >= _IN_A_ROW and not frozen:
                return
            if time.monotonic() - written_s > longest_s:
                state += ", a frozen sensor" if frozen else ""
                raise NotVentedError(
                    f"after {longest_s:g} s at vent, {failed}{state}; vented is {limit_kpa:g} or "
                    "less (valves.vented_kpa)"
                )


def vent_from_outside(hardware: Mapping[str, Any]) -> Iterator[str]:
    """Vent both chambers after another process has driven them; as ``Pneumatics.vent``."""
    pneumatics = Pneumatics(hardware, reset=False)
    try:
        yield from pneumatics.vent()
    finally:
        with suppress(DeviceError):
            _call_all([pneumatics.exhaust, pneumatics.release])


class HardwareRig(Pneumatics):
    """The paper's apparatus (Sec. II-B, Fig. 3).

    ``elapsed`` returns the time since the start of the run, s, which becomes the time of a reading.
    Until ``close`` it holds the ``locks`` of the boards. DeviceError: they cannot be had, and
    nothing was moved; or a part cannot be opened, and the others are released, vented.
    """

    def __init__(
        self,
        hardware: Mapping[str, Any],
        elapsed: Callable[[], float],
        sleep: Callable[[float], None],
        locks: AbstractContextManager[Any],
    ):
        self._elapsed, self._sleep = elapsed, sleep
        self._angles: list[BendSensor] = []
        with ExitStack() as held:
            held.enter_context(locks)
            super().__init__(hardware, reset=True)
            self._locks = held.pop_all()
        try:
            self.exhaust()  # even at rest: a closed valve leaks, and would fill the chamber
            self._inputs = self._open_inputs()
            for place in filter(None, (hardware["theta"], hardware["phi"])):
                self._angles.append(BendSensor(**place))
                self._angles[-1].start(sleep)
        except BaseException:
            with suppress(DeviceError):
                self._end(self.exhaust)  # tries to vent once more
            raise

    def read(self) -> Readings:
        """Return the latest reading of every sensor; NaN for a sensor that the rig lacks.

        DeviceError: a board or a sensor does not answer.
        """
        stamp = self._elapsed()
        p_exp, p_i, p_o = self.pressures()
        theta, *phi = [sensor.read() for sensor in self._angles]
        return Readings(stamp, p_exp, theta, p_i, p_o, *phi)

    def close(self) -> None:
        """Vent, wait until readings confirm it, and release every part, even if a step fails.

        DeviceError: no reading confirms that both chambers are vented, or a part reports an error.
        """

        def vent() -> None:
            for _ in self.vent():
                self._sleep(POLL_S)

        self._end(vent)

    def _end(self, vent: Callable[[], None]) -> None:
        with self._locks:
            _call_all([vent, self.release, *(sensor.shutdown for sensor in self._angles)])


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
