"""Recompute the checksums of HDF5 object headers, so that a damaged file can be opened.

Otherwise one wrong byte in an attribute makes the whole file unreadable, because the library
rejects the header that holds it. See the HDF5 File Format Specification, version 3,
Sec. IV.A.1.b; the checksum is Jenkins' lookup3.
"""

import struct
from collections.abc import Iterator

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
    """Yield begin and end of the headers and of their continuation blocks."""
    begin, count = data.find(_HEADER), 0
    while begin >= 0 and count < _MOST_BLOCKS:
        todo = [_header_block(data, begin)]
        while todo and count < _MOST_BLOCKS:
            block = todo.pop()
            if block is None:
                continue
            count += 1
            first, messages, end, ordered = block
            yield first, end
            todo += _continuation_blocks(data, messages, end - _CHECKSUM, ordered)
        begin = data.find(_HEADER, begin + 1)


#: Begin of a block, begin of its messages, its end, and whether messages are numbered.
_Block = tuple[int, int, int, bool]


def _header_block(data: bytes | bytearray, begin: int) -> _Block | None:
    if len(data) < begin + 6 or data[begin + 4] != 2:
        return None
    flags = data[begin + 5]
    at = begin + 6 + (16 if flags & 0x20 else 0) + (4 if flags & 0x10 else 0)
    width = 1 << (flags & 3)
    messages = at + width
    end = messages + int.from_bytes(data[at:messages], "little") + _CHECKSUM
    return (begin, messages, end, bool(flags & 4)) if end <= len(data) else None


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

    full = (len(data) - 1) // 12 * 12
    for at in range(0, full, 12):
        x, y, z = struct.unpack_from("<III", data, at)
        a, b, c = (a + x) & mask, (b + y) & mask, (c + z) & mask
        a = ((a - c) & mask) ^ rotated(c, 4)
        c = (c + b) & mask
        b = ((b - a) & mask) ^ rotated(a, 6)
        a = (a + c) & mask
        c = ((c - b) & mask) ^ rotated(b, 8)
        b = (b + a) & mask
        a = ((a - c) & mask) ^ rotated(c, 16)
        c = (c + b) & mask
        b = ((b - a) & mask) ^ rotated(a, 19)
        a = (a + c) & mask
        c = ((c - b) & mask) ^ rotated(b, 4)
        b = (b + a) & mask
    x, y, z = struct.unpack("<III", bytes(data[full:]).ljust(12, b"\0"))
    a, b, c = (a + x) & mask, (b + y) & mask, (c + z) & mask
    for which, by in (("c", 14), ("a", 11), ("b", 25), ("c", 16), ("a", 4), ("b", 14), ("c", 24)):
        if which == "c":
            c = ((c ^ b) - rotated(b, by)) & mask
        elif which == "a":
            a = ((a ^ c) - rotated(c, by)) & mask
        else:
            b = ((b ^ a) - rotated(a, by)) & mask
    return c
