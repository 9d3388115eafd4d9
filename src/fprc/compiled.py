"""One decorator for compiled functions, with a cache that cannot go stale."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba


def kernel(function: Callable[..., Any], **options: Any) -> Callable[..., Any]:
    """Compile ``function`` with numba and cache the machine code on disk, where numba does.

    numba drops a cached kernel when its file changes, but not when another file changes that
    defines a function it calls. The names of the cache's files therefore have a hash of this file,
    ``fprc.control_laws`` and all sources of the kernel's package; a kernel must not call one of
    another package. If no folder can be written, each process compiles again.
    """
    options |= {"error_model": "numpy"}
    try:
        Path.home()  # without one, numba would make a folder named ~
        compiled = numba.njit(cache=True, **options)(function)
    except RuntimeError:  # there is none, or numba found no folder
        return numba.njit(**options)(function)
    cache, here = compiled._cache, Path(__file__)  # noqa: SLF001
    package = Path(function.__code__.co_filename).parent
    sources = (here, here.with_name("control_laws.py"), *sorted(package.glob("*.py")))
    stamp = hashlib.sha256(b"".join(source.read_bytes() for source in sources)).hexdigest()
    # numba has no public names for these. A stamp alone would not do: after a full disk or a kill
    # between its writes, a new index names the machine code of the old sources
    name = f"{cache._impl.filename_base}.{stamp[:16]}"  # noqa: SLF001
    cache._cache_file = type(cache._cache_file)(cache.cache_path, name, stamp)  # noqa: SLF001
    load = cache.load_overload

    def load_or_forget(*arguments: Any) -> Any:
        # a full disk or a power cut leaves files that cannot be read
        try:
            return load(*arguments)
        except Exception:  # unpickling damaged bytes raises any type
            cache.flush()
            return None

    cache.load_overload = load_or_forget
    return compiled


def summing_kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile as ``kernel``, but allow the compiler to reorder sums for vector instructions."""
    return kernel(function, fastmath={"reassoc", "contract"})
