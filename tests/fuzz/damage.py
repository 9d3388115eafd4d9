"""Damage to the bytes of a file of any kind."""

from collections.abc import Callable, Sequence

import numpy as np

Damage = Callable[[np.random.Generator, bytes], tuple[bytes, str]]


def flip(rng: np.random.Generator, data: bytes, places: Sequence[int] | None = None):
    """Change one to three bytes, at one of the places."""
    changed, flips = bytearray(data), []
    for _ in range(int(rng.choice([1, 1, 1, 2, 3]))):
        at = int(rng.integers(len(data)) if places is None else rng.choice(places))
        # a bit error of disk or memory, or another byte
        mask = 1 << int(rng.integers(8)) if rng.random() < 0.5 else int(rng.integers(1, 256))
        changed[at] ^= mask
        flips.append(f"byte {at} ^ {mask:#04x}")
    return bytes(changed), ", ".join(flips)


def cut(rng: np.random.Generator, data: bytes):
    """Truncate the file."""
    at = int(rng.integers(len(data)))
    return data[:at], f"cut at byte {at}"


def lengthen(rng: np.random.Generator, data: bytes):
    """Append random bytes, or the file itself."""
    more = rng.bytes(int(rng.integers(1, 5000))) if rng.random() < 0.7 else data
    return data + more, f"{len(more)} bytes appended"


def blank(rng: np.random.Generator, data: bytes):
    """Set a range to zeros, as a disk returns blocks that were never written."""
    at, size = _stretch(rng, data)
    return data[:at] + bytes(size) + data[at + size :], f"zeros in bytes {at} to {at + size}"


def scramble(rng: np.random.Generator, data: bytes):
    """Fill a range with random bytes."""
    at, size = _stretch(rng, data)
    return data[:at] + rng.bytes(size) + data[at + size :], f"noise in bytes {at} to {at + size}"


def drop(rng: np.random.Generator, data: bytes):
    """Remove a range."""
    at, size = _stretch(rng, data)
    return data[:at] + data[at + size :], f"bytes {at} to {at + size} taken out"


def swap(rng: np.random.Generator, data: bytes):
    """Exchange two ranges."""
    size = _stretch(rng, data)[1]
    a, b = sorted(int(at) for at in rng.integers(0, len(data) - size + 1, 2))
    if b < a + size:
        return blank(rng, data)
    first, second = data[a : a + size], data[b : b + size]
    swapped = data[:a] + second + data[a + size : b] + first + data[b + size :]
    return swapped, f"{size} bytes at {a} and {b} exchanged"


def repeat(rng: np.random.Generator, data: bytes):
    """Repeat a range."""
    at, size = _stretch(rng, data)
    return data[: at + size] + data[at:], f"bytes {at} to {at + size} repeated"


#: Every kind of damage except ``flip``.
ROUGH: tuple[Damage, ...] = (cut, cut, lengthen, blank, scramble, drop, swap, repeat)


def _stretch(rng: np.random.Generator, data: bytes) -> tuple[int, int]:
    size = int(min(2 ** rng.uniform(0.0, 12.0), max(len(data) // 2, 1)))
    return int(rng.integers(len(data) - size + 1)), size
