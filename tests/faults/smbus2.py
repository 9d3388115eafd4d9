"""Stand-in for smbus2 without I2C: put this folder on PYTHONPATH.

The sensor is written from the manufacturer's driver, without using fprc, so it tests fprc
independently.

The environment variable FAKE_BENCH names a file that another process updates continuously;
without it there is no bus. Little-endian, at these offsets:

====  =======  ======================================================
320   float64  angle of the sensor 0x12, deg
328   float64  angle of the sensor at every other address, deg
336   int32    fault of both: 0 none, 1 dropout, 2 freeze, 3 spike of
               +90 deg, 4 wrong packet type, 5 bytes in the wrong order,
               6 packet cut short
====  =======  ======================================================
"""

import ctypes
import errno
import mmap
import os
import struct
from collections import deque
from collections.abc import Callable

THETA, PHI, FAULT = 320, 328, 336
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
        angle_deg = self._angle_deg()
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
            case _:
                raise ValueError(f"the sensor has no command {packet.hex(' ')}")


class i2c_msg:  # noqa: N801, smbus2's name
    """One message, with the attributes of smbus2's."""

    def __init__(self, addr, flags, content):
        self.addr, self.flags, self.len = addr, flags, len(content)
        self.buf = ctypes.create_string_buffer(content, len(content))

    @staticmethod
    def read(address, length):
        return i2c_msg(address, 1, bytes(length))

    @staticmethod
    def write(address, buf):
        return i2c_msg(address, 0, bytes(buf))

    def __bytes__(self):
        return self.buf.raw[: self.len]

    def __len__(self):
        return self.len

    def __iter__(self):
        return iter(bytes(self))


class SMBus:
    """Bus on which a sensor answers at every address."""

    def __init__(self, bus):
        path = os.environ.get("FAKE_BENCH")
        if not path:
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), f"/dev/i2c-{bus}")
        with open(path, "rb") as file:
            self._bench = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        self._sensors = {}

    def close(self):
        self._bench.close()

    def i2c_rdwr(self, *messages):
        (code,) = struct.unpack_from("<i", self._bench, FAULT)
        for message in messages:
            sensor = self._sensor(message.addr)
            sensor.fault = FAULTS[code]
            sensor.i2c_rdwr(message)

    def _sensor(self, address):
        if address not in self._sensors:
            offset = THETA if address == 0x12 else PHI
            self._sensors[address] = FakeBus(
                lambda: struct.unpack_from("<d", self._bench, offset)[0], address=address
            )
        return self._sensors[address]
