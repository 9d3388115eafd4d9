"""An I2C bus with one simulated Bend Labs sensor, which can be made to fail.

Written from the manufacturer's driver, without using fprc, so it tests fprc independently.
"""

import errno
import os
import struct
from collections import deque
from collections.abc import Callable

LENGTH = 3
#: Codes of an answer: a bend sample; a stretch sample; no answer, the lines stay high.
SAMPLE, STRETCH, NOTHING = 0x00, 0x03, 0xFF
#: By the codes of the shared memory, 0 for none.
FAULTS = (None, "dropout", "freeze", "spike", "type", "order", "length")


class FakeBus:
    """Bus with ``i2c_rdwr`` as of smbus2; messages are smbus2's or like them.

    Every reading takes a new sample: the sensor's own rate is not imitated.

    Parameters
    ----------
    angle_deg : callable
        Gives the true angle, which an uncalibrated sensor tells.
    address : int
        The only address that answers.

    Attributes
    ----------
    state : str
        standby or running; samples come in the latter only.
    ticks : int or None
        Sample time as commanded, 1/16384 s.
    fault : str or None
        One of ``FAULTS``, until it is set to None.
    exchanged : deque of (str, bytes)
        ``write`` or ``read`` and the bytes; the latest 100 000.
    """

    def __init__(self, angle_deg: Callable[[], float], *, address: int = 0x12):
        self._angle_deg = angle_deg
        self._address = address
        self._zero_deg, self._gain = 0.0, 1.0
        self.fault = self.ticks = self._last = None
        self.state = "standby"
        self.exchanged = deque(maxlen=100_000)

    def i2c_rdwr(self, *messages) -> None:
        """Exchange messages; OSError if no device answers."""
        for message in messages:
            if self.fault == "dropout" or message.addr != self._address:
                raise OSError(errno.EREMOTEIO, os.strerror(errno.EREMOTEIO))
            if message.flags & 1:
                answer = self._answer()[: message.len]
                message.len = len(answer)
                for k, byte in enumerate(answer):
                    message.buf[k] = bytes([byte])
                self.exchanged.append(("read", answer))
            else:
                self.exchanged.append(("write", bytes(message)))
                self._obey(bytes(message))

    def _answer(self) -> bytes:
        if self.state != "running":
            return bytes([NOTHING] * LENGTH)
        if self._last is not None and self.fault == "freeze":
            return self._last
        angle_deg = (self._angle_deg() - self._zero_deg) * self._gain
        if self.fault == "spike":
            angle_deg += 90.0
        counts = min(max(round(angle_deg * 64), -32768), 32767)
        code = STRETCH if self.fault == "type" else SAMPLE
        self._last = packet = struct.pack("<Bh", code, counts)
        if self.fault == "order":
            return packet[1:] + packet[:1]
        if self.fault == "length":
            return packet[:-1]
        return packet

    def _obey(self, packet: bytes) -> None:
        match tuple(packet):
            case (0x00, on, 0) if on in (0, 1):
                self.state = "running" if on else "standby"
            case (0x01, low, high):
                self.ticks = low + 256 * high
            case (0x07, 0, 0):
                self._zero_deg = self._angle_deg()
            case (0x07, 1, degrees) if degrees >= 45:
                self._gain = degrees / (self._angle_deg() - self._zero_deg)
            case (0x07, 2, 0):
                self._zero_deg, self._gain = 0.0, 1.0
            case _:
                raise ValueError(f"the sensor has no command {packet.hex(' ')}")
