"""Recompute the checksums of HDF5 object headers, so that a damaged file can be opened.

Otherwise one wrong byte in an attribute makes the whole file unreadable, because the library
rejects the header that holds it. See the HDF5 File Format Specification, version 3,
Sec. IV.A.1.b; the checksum is Jenkins' lookup3.
"""

import re
import struct
from collections.abc import Iterator
from itertools import islice

_HEADER, _MORE = b"OHDR", b"OCHK"
#: Type of the message that points to a header's next block.
_CONTINUATION = 0x10
_CHECKSUM = 4
#: Limit on blocks; logs have far fewer.
_MOST_BLOCKS = 10_000


def correct_checksums(data: bytearray) -> int:
    """Correct the checksums of a file's object headers in place; return how many were wrong.

    The damaged bytes stay: a header may now hold a wrong name or value.
    """
    wrong = 0
    for begin, end in _blocks(data):
        right = lookup3(data[begin : end - _CHECKSUM])
        if right != int.from_bytes(data[end - _CHECKSUM : end], "little"):
            data[end - _CHECKSUM : end] = right.to_bytes(_CHECKSUM, "little")
            wrong += 1
    return wrong


def _blocks(data: bytes | bytearray) -> Iterator[tuple[int, int]]:
    """Yield the begin and end of each header and of each of its continuation blocks."""
    count, todo = 0, list(islice(_header_blocks(data), _MOST_BLOCKS))[::-1]
    while todo and count < _MOST_BLOCKS:
        count += 1
        first, messages, end, ordered = todo.pop()
        yield first, end
        todo += _continuation_blocks(data, messages, end - _CHECKSUM, ordered)


#: Begin of a block, begin of its messages, its end, and whether messages are numbered.
_Block = tuple[int, int, int, bool]


def _header_blocks(data: bytes | bytearray) -> Iterator[_Block]:
    for begin in (found.start() for found in re.finditer(_HEADER, data)):
        if len(data) < begin + 6 or data[begin + 4] != 2:
            continue
        flags = data[begin + 5]
        at = begin + 6 + (16 if flags & 0x20 else 0) + (4 if flags & 0x10 else 0)
        messages = at + (1 << (flags & 3))
        end = messages + int.from_bytes(data[at:messages], "little") + _CHECKSUM
        if end <= len(data):
            yield begin, messages, end, bool(flags & 4)


def _continuation_blocks(
    data: bytes | bytearray, at: int, end: int, ordered: bool
) -> Iterator[_Block]:
    head = 6 if ordered else 4
    while at + head <= end:
        kind, size = data[at], int.from_bytes(data[at + 1 : at + 3], "little")
        if kind == _CONTINUATION and size >= 16 and at + head + 16 <= end:
            begin, length = struct.unpack_from("<QQ", data, at + head)
            last = begin + length
            if last <= len(data) and length > 8 and data[begin : begin + 4] == _MORE:
                yield begin, begin + 4, last, ordered
        at += head + size


def lookup3(data: bytes | bytearray, seed: int = 0) -> int:
    """Return Jenkins' hash of 32 bits (``hashlittle`` of lookup3.c)."""
    mask = 0xFFFFFFFF
    a = b = c = (0xDEADBEEF + len(data) + seed) & mask
    if not data:
        return c

    def rotated(x: int, by: int) -> int:
        return ((x << by) | (x >> (32 - by))) & mask

    padded = bytes(data).ljust(-(-len(data) // 12) * 12, b"\0")
    for at in range(0, len(padded), 12):
        x, y, z = struct.unpack_from("<III", padded, at)
        a, b, c = (a + x) & mask, (b + y) & mask, (c + z) & mask
        if at + 12 < len(padded):
            for by in (4, 6, 8, 16, 19, 4):  # each step exchanges the roles of a, b and c
                a, b, c = b, (c + b) & mask, ((a - c) & mask) ^ rotated(c, by)
    for by in (14, 11, 25, 16, 4, 14, 24):
        a, b, c = b, ((c ^ b) - rotated(b, by)) & mask, a
    return b
