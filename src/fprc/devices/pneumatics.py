"""The pneumatic side of the real rig: both valves, the pressure sensors, and how to vent."""

import contextlib
import time
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from fprc.devices.contec import AnalogInput, AnalogOutput, load_library
from fprc.errors import DeviceError

#: The two voltages of the heartbeat, which a watchdog relay counts.
_HEARTBEAT_V = (0.0, 5.0)
#: Time between two looks at a chamber that vents, s.
_LOOK_S = 0.02
#: So many readings in a row must be those of a vented chamber.
_IN_A_ROW = 10


class NotVentedError(DeviceError):
    """The valves were told to vent, and no reading shows that the chambers did."""


class Valves:
    """Both proportional valves on the output board, and the heartbeat if it has one.

    Parameters
    ----------
    hardware : Mapping
        As in ``fprc.config.hardware.Hardware``.
    """

    def __init__(self, board: AnalogOutput, hardware: Mapping[str, Any]):
        boards = hardware["boards"]
        self._board = board
        self._main = boards["main_output"]
        self._reservoir = boards["reservoir_output"]
        self._heartbeat = boards["heartbeat_output"]
        self._beats = 0
        self._voltages = hardware["valves"]

    def write(self, main_v: float, reservoir_v: float) -> None:
        """Hold these voltages; if both valves have them, the heart beats.

        Raises
        ------
        DeviceError
            The driver reports an error; the other valve was written all the same.
        """
        self._all([(self._main, main_v), (self._reservoir, reservoir_v)])
        if self._heartbeat is not None:
            self._beats += 1
            self._board.write(self._heartbeat, _HEARTBEAT_V[self._beats % 2])

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
        each(self.let_out, self.release)

    def let_out(self) -> None:
        """Open both chambers to the room at once."""
        vent_v = self._voltages["vent_v"]
        self._all([(self._main, vent_v), (self._reservoir, vent_v)])

    def release(self) -> None:
        """Release the board, which holds its last voltages."""
        self._board.close()

    def _all(self, writes: Iterable[tuple[int, float]]) -> None:
        each(*(_later(self._board.write, channel, volts) for channel, volts in writes))


class Pressures:
    """The three pressure sensors on the input board.

    Parameters
    ----------
    hardware : Mapping
        As in ``fprc.config.hardware.Hardware``.

    Raises
    ------
    DeviceError
        The driver or the board cannot be opened.
    """

    def __init__(self, hardware: Mapping[str, Any]):
        boards, names = hardware["boards"], ("p_exp", "p_i", "p_o")
        self._channels = [boards[f"{name}_input"] for name in names]
        self._scales = [(hardware[n]["zero_v"], hardware[n]["gain_kpa_per_v"]) for n in names]
        library = load_library(boards["library"])
        self._board = AnalogInput(library, boards["input_device"], 1 + max(self._channels))
        self.close = self._board.close

    def read(self) -> list[float]:
        """Return P_exp, P_i and P_o now, kPa gauge.

        Raises
        ------
        DeviceError
            The driver reports an error.
        """
        volts = self._board.read()
        return [
            (volts[channel] - zero) * gain
            for channel, (zero, gain) in zip(self._channels, self._scales, strict=True)
        ]


def board_names(boards: Mapping[str, Any]) -> list[str]:
    """Return the device names of both boards."""
    return [boards["input_device"], boards["output_device"]]


def vent(
    valves: Valves,
    open_inputs: Callable[[], Pressures],
    voltages: Mapping[str, Any],
    *,
    told: Callable[[str], None] = lambda what: None,
    persist: Callable[[], bool] = lambda: False,
    sleep: Callable[[float], None] = time.sleep,
    now: Callable[[], float] = time.monotonic,
) -> None:
    """Tell both valves to vent, again and again, until readings show that both chambers did.

    A chamber is vented when its sensor has read ``vented_kpa`` or less ten times in a row, and
    is not frozen: its reading has changed since the beginning. The valves are told anew before
    each reading: a board may fail for a moment.

    Parameters
    ----------
    open_inputs : callable
        Gives the input board; called again after it raised DeviceError.
    told : callable
        Given why the valves could not be told; empty once they were.
    persist : callable
        Asked, after ``vent_s`` in which the valves could not be told, whether to go on.

    Raises
    ------
    NotVentedError
        The valves were told to vent for ``vent_s``, and no reading shows that the chambers did.
    DeviceError
        The valves could not be told.
    """
    began_s, written_s = now(), None
    looks = _Looks(voltages["vented_kpa"])
    while True:
        failed = ""
        try:
            valves.let_out()
        except DeviceError as error:
            failed = f"{error}; "
            told(str(error))
            if written_s is None and now() - began_s > voltages["vent_s"] and not persist():
                raise
        else:
            told("")
            written_s = now() if written_s is None else written_s
        seen = looks.look(open_inputs)
        if written_s is not None:
            if looks.vented:
                return
            if now() - written_s > voltages["vent_s"]:
                raise not_vented(f"after {voltages['vent_s']:g} s {failed}{seen}")
        sleep(_LOOK_S)


class _Looks:
    """Readings of both chambers, one after the other."""

    def __init__(self, limit_kpa: float):
        self._limit_kpa = limit_kpa
        self._first: list[float] = []
        self._changed = [False, False]
        self._in_a_row = 0

    @property
    def vented(self) -> bool:
        return self._in_a_row >= _IN_A_ROW and all(self._changed)

    def look(self, open_inputs: Callable[[], Pressures]) -> str:
        """Read once more; return what was seen."""
        try:
            kpa = open_inputs().read()[:2]
        except DeviceError as error:
            self._in_a_row = 0
            return f"no pressure can be read ({error})"
        self._first = self._first or kpa
        self._changed = [
            moved or a != b for moved, a, b in zip(self._changed, self._first, kpa, strict=True)
        ]
        # a sensor without a cable reads far below 0
        within = all(abs(value) <= self._limit_kpa for value in kpa)
        self._in_a_row = self._in_a_row + 1 if within else 0
        names = ("p_exp_kpa", "p_i_kpa")
        frozen = [name for name, moved in zip(names, self._changed, strict=True) if not moved]
        return (
            " and ".join(f"{name} = {value:.1f}" for name, value in zip(names, kpa, strict=True))
            + f", where {self._limit_kpa:g} or less is vented (hardware.valves.vented_kpa)"
            + (f"; {' and '.join(frozen)} never changed, a frozen sensor" if frozen else "")
        )


def not_vented(why: str) -> NotVentedError:
    """Return the error of valves that were told to vent, with what is to be done by hand."""
    return NotVentedError(
        f"THE CHAMBERS MAY BE UNDER PRESSURE: both valves were told to vent, but {why}. Cut the "
        "supply and open the chambers by hand; if a gauge shows 0 kPa, check the sensors' cables "
        "and zero_v"
    )


def vent_from_outside(hardware: Mapping[str, Any], told: Callable[[str], None]) -> None:
    """Vent both chambers over connections of its own, whatever another process left them at.

    The caller holds the locks of the boards.

    Parameters
    ----------
    told : callable
        See ``vent``.

    Raises
    ------
    NotVentedError
        See ``vent``.
    DeviceError
        The output board cannot be opened, or the valves cannot be told.
    """
    opened: list[Pressures] = []

    def open_inputs() -> Pressures:
        if not opened:
            opened.append(Pressures(hardware))
        return opened[0]

    valves = Valves(_output_board(hardware, reset=False), hardware)
    try:
        vent(valves, open_inputs, hardware["valves"], told=told)
    finally:
        for close in (valves.close, *(inputs.close for inputs in opened)):
            quietly(close)


def open_valves(hardware: Mapping[str, Any]) -> Valves:
    """Open the output board in its power-on state and vent both chambers.

    A closed valve leaks: a chamber that is left behind it fills slowly.

    Raises
    ------
    DeviceError
        The driver or the board cannot be opened.
    """
    valves = Valves(_output_board(hardware, reset=True), hardware)
    try:
        valves.let_out()
    except DeviceError:
        quietly(valves.close)  # which tries once more
        raise
    return valves


def _output_board(hardware: Mapping[str, Any], *, reset: bool) -> AnalogOutput:
    boards = hardware["boards"]
    return AnalogOutput(load_library(boards["library"]), boards["output_device"], reset=reset)


def _later(call: Callable[..., None], *arguments: Any) -> Callable[[], None]:
    return lambda: call(*arguments)


def each(*calls: Callable[[], None]) -> None:
    """Make every call, then raise what went wrong in any of them."""
    problems = []
    for call in calls:
        try:
            call()
        except (DeviceError, OSError) as error:
            problems.append(str(error))
    if problems:
        raise DeviceError("\n".join(dict.fromkeys(problems)))


def quietly(call: Callable[[], None]) -> None:
    """Make a call whose failure is told elsewhere, or does not matter any more."""
    with contextlib.suppress(DeviceError, OSError):
        call()
