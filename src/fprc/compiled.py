"""One decorator for compiled functions, with a cache that cannot go stale."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba

_CONFIG: Any = numba.config


def kernel(function: Callable[..., Any], **options: Any) -> Callable[..., Any]:
    """Compile ``function`` with numba and cache the machine code on disk.

    numba drops a cached kernel when its own file changes, but not when another
    file changes that defines a function it calls. The name of the cache folder
    therefore holds a hash of this file and of all sources of the kernel's package.
    A kernel must not call a kernel of another package.
    """
    before = _CONFIG.CACHE_DIR
    _CONFIG.CACHE_DIR = str(_cache_folder(Path(function.__code__.co_filename).parent))
    try:
        return numba.njit(cache=True, error_model="numpy", **options)(function)
    finally:
        _CONFIG.CACHE_DIR = before


def summing_kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile as ``kernel``, but allow the compiler to reorder sums for vector instructions."""
    return kernel(function, fastmath={"reassoc", "contract"})


def _cache_folder(package: Path) -> Path:
    digest = hashlib.sha256()
    for source in (Path(__file__), *sorted(package.glob("*.py"))):
        digest.update(source.read_bytes())
    folder = Path(_CONFIG.CACHE_DIR or package / "__pycache__")
    return folder / f"kernels-{digest.hexdigest()[:16]}"
