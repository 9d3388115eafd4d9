"""One decorator for compiled functions, with a cache that cannot go stale."""

import hashlib
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numba
from numba.misc.appdirs import user_cache_dir

_CONFIG: Any = numba.config


def kernel(function: Callable[..., Any], **options: Any) -> Callable[..., Any]:
    """Compile ``function`` with numba and cache the machine code on disk.

    numba drops a cached kernel when its file changes, but not when another
    file changes that defines a function it calls. The name of the cache folder
    therefore holds a hash of this file, of ``fprc.control_laws``, and of all sources
    of the kernel's package. A kernel must not call a kernel of another package.

    The folder is below ``NUMBA_CACHE_DIR`` if that is set, else in the package's
    ``__pycache__``. If that cannot be written, it is in the user's cache folder;
    if neither can, each process compiles again.
    """
    folder = _cache_folder(Path(function.__code__.co_filename).parent)
    before = _CONFIG.CACHE_DIR
    _CONFIG.CACHE_DIR = str(folder or before)
    try:
        compiled = numba.njit(cache=folder is not None, error_model="numpy", **options)(function)
        if folder:
            _forgive(compiled._cache)  # noqa: SLF001  # numba has no public name for it
        return compiled
    finally:
        _CONFIG.CACHE_DIR = before


def _forgive(cache: Any) -> None:
    """Let a cache forget files that cannot be read, as a full disk or a power cut leaves them."""
    load = cache.load_overload

    def load_or_forget(*arguments: Any) -> Any:
        try:
            return load(*arguments)
        except Exception:  # unpickling damaged bytes raises any type
            cache.flush()
            return None

    cache.load_overload = load_or_forget


def summing_kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile as ``kernel``, but allow the compiler to reorder sums for vector instructions."""
    return kernel(function, fastmath={"reassoc", "contract"})


def _cache_folder(package: Path) -> Path | None:
    """Return the folder of a package's machine code; None if none can be written."""
    digest = hashlib.sha256()
    here = Path(__file__)
    for source in (here, here.with_name("control_laws.py"), *sorted(package.glob("*.py"))):
        digest.update(source.read_bytes())
    of_user = user_cache_dir("fprc", appauthor=False)  # type: ignore[no-untyped-call]
    for parent in (_CONFIG.CACHE_DIR or package / "__pycache__", Path(of_user, package.name)):
        folder = Path(parent, f"kernels-{digest.hexdigest()[:16]}")
        if not str(folder).startswith("~"):  # the user has a home
            with suppress(OSError):
                folder.mkdir(parents=True, exist_ok=True)
                if os.access(folder, os.W_OK):
                    return folder
    return None
