"""Bend Labs one-axis angle sensor on an I2C bus, in packets of a code and two bytes of content.

Codes and delays are those of the manufacturer's driver (github.com/bendlabs/one_axis_ads).
"""

import math
import struct
from collections.abc import Callable
from typing import Any

from fprc.errors import DeviceError

_RUN, _SPS = 0x00, 0x01
_SAMPLE = 0x00  # code of a reply that holds an angle
_LENGTH, _DEG_PER_COUNT = 3, 1 / 64
#: Time between two samples, in units of 1/16384 s: 202.27 Hz, nominally 200.
_TICKS, _TICKS_HZ = 81, 16384
_SETTLE_S = 2e-3


class BendSensor:
    """One sensor and its bus; every method raises DeviceError if one of them does not answer.

    angle = packet / 64 * gain + offset_deg
    """

    def __init__(self, bus: int, address: int, gain: float, offset_deg: float):
        try:
            from smbus2 import SMBus, i2c_msg

            self._bus, self._message = SMBus(bus), i2c_msg
        except (ImportError, OSError) as error:
            raise DeviceError(
                f"I2C bus {bus}: cannot be opened ({error}); `pip install smbus2`, enable I2C, "
                "choose a bus that `i2cdetect -l` lists, and be a member of its group: `sudo "
                "usermod -aG i2c $USER`, then log in again"
            ) from error
        self._address, self._gain, self._offset_deg = address, gain, offset_deg
        self._deg = math.nan

    def start(self, sleep: Callable[[float], None]) -> None:
        """Start sampling, and wait for the first sample."""
        self._send("setting the sample rate", _SPS, *_TICKS.to_bytes(2, "little"))
        sleep(_SETTLE_S)
        self._send("starting it", _RUN, 1, 0)
        sleep(max(_SETTLE_S, _TICKS / _TICKS_HZ))

    def read(self) -> float:
        """Return the latest angle in deg, which may be repeated; NaN before the first."""
        request = self._message.read(self._address, _LENGTH)
        code, counts = struct.unpack("<Bh", self._exchange("reading the angle", request))
        if code == _SAMPLE:
            self._deg = counts * _DEG_PER_COUNT * self._gain + self._offset_deg
        return self._deg

    def shutdown(self) -> None:
        """Stop sampling, and close the bus."""
        # not its command SHUTDOWN, 0x09: only the reset line or a power cycle wakes it from that
        try:
            self._send("stopping it", _RUN, 0, 0)
        finally:
            self._bus.close()

    def _send(self, action: str, *packet: int) -> None:
        self._exchange(action, self._message.write(self._address, bytes(packet)))

    def _exchange(self, action: str, message: Any) -> bytes:
        try:
            self._bus.i2c_rdwr(message)
            packet = bytes(message)
            if len(packet) != _LENGTH:
                raise OSError(f"the reply has {len(packet)} bytes, not {_LENGTH}")
        except OSError as error:
            raise DeviceError(
                f"angle sensor 0x{self._address:02x}: {action} failed ({error}); check cable, "
                "supply, bus and address: `i2cdetect -y BUS` lists the devices that answer"
            ) from error
        return packet
