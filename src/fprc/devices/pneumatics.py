"""The pneumatic side of the real rig: both valves, the pressure sensors, and how to vent."""

import contextlib
import time
from collections.abc import Callable, Mapping
from typing import Any

from fprc.devices.contec import AnalogInput, AnalogOutput, load_library
from fprc.errors import DeviceError

#: The two voltages of the heartbeat, which a watchdog relay counts.
_HEARTBEAT_V = (0.0, 5.0)
#: Time between two readings of a chamber that vents, s.
_LOOK_S = 0.02


class NotVentedError(DeviceError):
    """The valves were told to vent, and no reading shows that the chambers did."""


class Valves:
    """Both proportional valves on the output board, and the heartbeat if it has one.

    Parameters
    ----------
    boards, voltages : Mapping
        As in ``fprc.config.hardware``: ``boards`` and ``valves``.
    """

    def __init__(self, board: AnalogOutput, boards: Mapping[str, Any], voltages: Mapping[str, Any]):
        self._board = board
        self._main = boards["main_output"]
        self._reservoir = boards["reservoir_output"]
        self._heartbeat = boards["heartbeat_output"]
        self._beats = 0
        self._voltages = voltages

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

    def _all(self, writes) -> None:
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
    hardware: Mapping[str, Any],
    *,
    written: Callable[[], None] = lambda: None,
    sleep: Callable[[float], None] = time.sleep,
) -> None:
    """Vent both chambers over a connection of its own, and wait until a reading shows it.

    The caller holds the locks of the boards, or does without: another process may have left the
    valves open.

    Parameters
    ----------
    written : callable
        Called once the valves were told to vent, before anything is read.

    Raises
    ------
    NotVentedError
        The valves were told to vent, and no reading shows that the chambers did.
    DeviceError
        The valves could not be told.
    """
    valves = open_valves(hardware, reset=False)
    written()
    try:
        with contextlib.ExitStack() as opened:
            try:
                inputs = Pressures(hardware)
            except DeviceError as error:
                raise not_vented(f"no pressure can be read ({error})") from error
            opened.callback(quietly, inputs.close)
            see_vented(inputs, hardware["valves"], sleep)
    finally:
        quietly(valves.close)


def see_vented(
    inputs: Pressures, voltages: Mapping[str, Any], sleep: Callable[[float], None]
) -> None:
    """Wait until both chambers read vented; a reading that fails is taken again.

    Raises
    ------
    NotVentedError
        They do not after ``vent_s``; says what was read last.
    """
    limit_kpa, vent_s = voltages["vented_kpa"], voltages["vent_s"]
    for _ in range(1 + round(vent_s / _LOOK_S)):
        try:
            p_exp, p_i, _ = inputs.read()
        except DeviceError as error:
            seen = f"no pressure can be read ({error})"
        else:
            # a sensor without a cable reads far below 0
            if abs(p_exp) <= limit_kpa and abs(p_i) <= limit_kpa:
                return
            seen = (
                f"after {vent_s:g} s p_exp_kpa = {p_exp:.1f} and p_i_kpa = {p_i:.1f}, where "
                f"{limit_kpa:g} or less is vented (hardware.valves.vented_kpa)"
            )
        sleep(_LOOK_S)
    raise not_vented(seen)


def not_vented(why: str) -> NotVentedError:
    """Return the error of valves that were told to vent, with what is to be done by hand."""
    return NotVentedError(
        f"THE CHAMBERS MAY BE UNDER PRESSURE: both valves were told to vent, but {why}. Cut the "
        "supply and open the chambers by hand; if a gauge shows 0 kPa, check the sensors' cables "
        "and zero_v"
    )


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
        quietly(valves.close)  # which tries once more
        raise
    return valves


def _later(call: Callable[..., None], *arguments) -> Callable[[], None]:
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
