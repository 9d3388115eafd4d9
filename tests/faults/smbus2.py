"""Stand-in for smbus2 without I2C: put this folder on PYTHONPATH.

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

from fake_bus import FAULTS, FakeBus

THETA, PHI, FAULT = 320, 328, 336


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
