"""Stand-in for smbus2 without I2C: put this folder on PYTHONPATH.

The sensor is written from the manufacturer's driver, without using fprc, so it tests fprc
independently. The environment variable FAKE_BENCH names the shared memory (see fake_caio.c), which
has the angles of the sensor 0x12 and of one at any other address, and the fault of both; without
it there is no bus.
"""

import errno
import mmap
import os
import struct
from collections import defaultdict, deque

ANGLES, FAULT = 328, 344
#: Codes of an answer: a bend sample; a stretch sample; no answer, the lines stay high.
SAMPLE, STRETCH, NOTHING = 0x00, 0x03, 0xFF
#: By the codes of the shared memory.
FAULTS = (None, "dropout", "freeze", "spike", "type", "order", "length")


class Sensor:
    """A sensor with a new sample at each reading; ``ticks`` is its sample time, 1/16384 s."""

    def __init__(self):
        self.ticks = self._last = None
        self.state = "standby"

    def answer(self, angle_deg, fault):
        if self.state != "running":
            return bytes([NOTHING] * 3)
        if self._last is not None and fault == "freeze":
            return self._last
        counts = round((angle_deg + (90.0 if fault == "spike" else 0.0)) * 64)
        code = STRETCH if fault == "type" else SAMPLE
        self._last = packet = struct.pack("<Bh", code, min(max(counts, -32768), 32767))
        return {"order": packet[1:] + packet[:1], "length": packet[:-1]}.get(fault, packet)

    def obey(self, code, low, high):
        if code == 0x00 and (low, high) in ((0, 0), (1, 0)):
            self.state = "running" if low else "standby"
        elif code == 0x01:
            self.ticks = low + 256 * high
        else:
            raise ValueError(f"the sensor has no command {code:02x} {low:02x} {high:02x}")


class i2c_msg:  # noqa: N801, smbus2's name
    """One message, as smbus2's."""

    def __init__(self, addr, reads, content):
        self.addr, self.reads, self.len, self.content = addr, reads, len(content), content

    @staticmethod
    def read(address, length):
        return i2c_msg(address, True, bytes(length))

    @staticmethod
    def write(address, buf):
        return i2c_msg(address, False, bytes(buf))

    def __bytes__(self):
        return self.content


class SMBus:
    """Bus on which a sensor answers at every address; ``written`` has the bytes of commands."""

    def __init__(self, bus):
        path = os.environ.get("FAKE_BENCH")
        if not path:
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), f"/dev/i2c-{bus}")
        with open(path, "rb") as file:
            self._bench = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        self.sensors, self.written = defaultdict(Sensor), deque(maxlen=100)

    def close(self):
        self._bench.close()

    def i2c_rdwr(self, message):
        fault = FAULTS[self._bench[FAULT]]
        if fault == "dropout":
            raise OSError(errno.EREMOTEIO, os.strerror(errno.EREMOTEIO))
        sensor = self.sensors[message.addr]
        if message.reads:
            at = ANGLES + 8 * (message.addr != 0x12)
            (angle_deg,) = struct.unpack_from("<d", self._bench, at)
            message.content = sensor.answer(angle_deg, fault)[: message.len]
        else:
            sensor.obey(*message.content)
            self.written.append(message.content)
