"""The real rig behind the device protocol: boards, pressure sensors, angle sensors."""

import contextlib
import math
import time
from collections.abc import Callable, Mapping
from typing import Any

from fprc.devices.bendlabs import BendSensor, open_bus
from fprc.devices.contec import AnalogInput, AnalogOutput, load_library
from fprc.devices.protocol import Readings
from fprc.errors import DeviceError


class Valves:
    """Both proportional valves on the output board.

    Parameters
    ----------
    boards, voltages : Mapping
        As in ``fprc.config.hardware``: ``boards`` and ``valves``.
    """

    def __init__(self, board: AnalogOutput, boards: Mapping[str, Any], voltages: Mapping[str, Any]):
        self._board = board
        self._main = boards["main_output"]
        self._reservoir = boards["reservoir_output"]
        self._voltages = voltages

    def write(self, main_v: float, reservoir_v: float) -> None:
        """Hold these voltages.

        Raises
        ------
        DeviceError
            The driver reports an error; the other valve was written all the same.
        """
        self._all([(self._main, main_v), (self._reservoir, reservoir_v)])

    def vent(self) -> None:
        """Close both valves, then open both chambers to the room.

        Each of the four writes is tried whatever became of those before.

        Raises
        ------
        DeviceError
            The driver reports an error.
        """
        self._all(
            (channel, self._voltages[state])
            for state in ("neutral_v", "vent_v")
            for channel in (self._main, self._reservoir)
        )

    def close(self) -> None:
        """Vent and release the board; a valve that is vented is not closed again before."""
        _each(self.let_out, self._board.close)

    def let_out(self) -> None:
        """Open both chambers to the room at once."""
        vent_v = self._voltages["vent_v"]
        self.write(vent_v, vent_v)

    def _all(self, writes) -> None:
        _each(*(_later(self._board.write, channel, volts) for channel, volts in writes))


class HardwareRig:
    """The paper's apparatus (Sec. II-B, Fig. 3).

    Parameters
    ----------
    hardware : Mapping
        As in ``fprc.config.hardware.Hardware``.
    elapsed : callable
        Gives the time since the start of the run, s: the stamp of a reading.
    open_bus : callable
        Gives the I2C bus of a number.

    Raises
    ------
    DeviceError
        Lists every part that cannot be opened; those that could are released.
    """

    def __init__(
        self,
        hardware: Mapping[str, Any],
        elapsed: Callable[[], float],
        *,
        open_bus: Callable[[int], Any] = open_bus,
        sleep: Callable[[float], None] = time.sleep,
    ):
        boards = hardware["boards"]
        names = ("p_exp", "p_i", "p_o")
        self._channels = [boards[f"{name}_input"] for name in names]
        self._scales = [(hardware[n]["zero_v"], hardware[n]["gain_kpa_per_v"]) for n in names]
        self._elapsed = elapsed
        self._buses: dict[int, Any] = {}
        with contextlib.ExitStack() as opened:
            parts: dict[str, Any] = {}

            def attempt(name: str, build: Callable[[], Any], release: str) -> str:
                try:
                    parts[name] = part = build()
                except DeviceError as error:
                    return str(error)
                opened.callback(_quietly, getattr(part, release))
                return ""

            def sensor(settings: Mapping[str, Any]) -> BendSensor:
                number = settings["bus"]
                if number not in self._buses:
                    self._buses[number] = bus = open_bus(number)
                    opened.callback(_quietly, bus.close)
                own = {key: settings[key] for key in ("ticks", "gain", "offset_deg")}
                built = BendSensor(self._buses[number], settings["address"], **own)
                built.start(sleep=sleep)
                return built

            tried = [
                attempt("valves", lambda: open_valves(hardware), "close"),
                attempt("inputs", lambda: _inputs(boards, 1 + max(self._channels)), "close"),
                attempt("theta", lambda: sensor(hardware["theta"]), "shutdown"),
            ]
            if hardware["phi"]:
                tried.append(attempt("phi", lambda: sensor(hardware["phi"]), "shutdown"))
            problems = list(dict.fromkeys(filter(None, tried)))
            if problems:
                raise DeviceError("\n".join(problems))
            opened.pop_all()
        self._valves: Valves = parts["valves"]
        self._inputs: AnalogInput = parts["inputs"]
        self._theta: BendSensor = parts["theta"]
        self._phi: BendSensor | None = parts.get("phi")
        self._angles = [math.nan, math.nan]

    def read(self) -> Readings:
        """Return the latest reading of every sensor; an absent one reads NaN.

        Raises
        ------
        DeviceError
            A board or a sensor does not answer.
        """
        stamp = self._elapsed()
        volts = self._inputs.read()
        kpa = [
            (volts[channel] - zero) * gain
            for channel, (zero, gain) in zip(self._channels, self._scales, strict=True)
        ]
        for k, sensor in enumerate((self._theta, self._phi)):
            angle = None if sensor is None else sensor.read()
            if angle is not None:
                self._angles[k] = angle
        return Readings(stamp, kpa[0], self._angles[0], kpa[1], kpa[2], self._angles[1])

    def write(self, main_v: float, reservoir_v: float) -> None:
        """Hold these voltages on the valves of actuator and reservoir."""
        self._valves.write(main_v, reservoir_v)

    def safe(self) -> None:
        """Close both valves, then vent both chambers."""
        self._valves.vent()

    def close(self) -> None:
        """Make safe and release boards and sensors; one failure never skips the next."""
        sensors = [sensor.shutdown for sensor in (self._theta, self._phi) if sensor]
        buses = [bus.close for bus in self._buses.values()]
        _each(self._valves.close, self._inputs.close, *sensors, *buses)


def open_valves(hardware: Mapping[str, Any], *, reset: bool = True) -> Valves:
    """Open the output board and vent both chambers.

    A closed valve leaks: a chamber that is left behind it fills slowly.

    Parameters
    ----------
    reset : bool
        See ``AnalogOutput``.

    Raises
    ------
    DeviceError
        The driver or the board cannot be opened.
    """
    boards = hardware["boards"]
    board = AnalogOutput(load_library(boards["library"]), boards["output_device"], reset=reset)
    valves = Valves(board, boards, hardware["valves"])
    try:
        valves.let_out()
    except DeviceError:
        _quietly(valves.close)  # which tries once more
        raise
    return valves


def _inputs(boards: Mapping[str, Any], n_channels: int) -> AnalogInput:
    return AnalogInput(load_library(boards["library"]), boards["input_device"], n_channels)


def _later(call: Callable[..., None], *arguments) -> Callable[[], None]:
    return lambda: call(*arguments)


def _each(*calls: Callable[[], None]) -> None:
    """Make every call, then raise what went wrong in any of them."""
    problems = []
    for call in calls:
        try:
            call()
        except (DeviceError, OSError) as error:
            problems.append(str(error))
    if problems:
        raise DeviceError("\n".join(dict.fromkeys(problems)))


def _quietly(call: Callable[[], None]) -> None:
    with contextlib.suppress(DeviceError, OSError):
        call()
