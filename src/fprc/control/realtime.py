"""Ask the operating system for punctuality; say what was granted."""

import ctypes
import gc
import os

_MCL_CURRENT, _MCL_FUTURE = 1, 2


def be_punctual(priority: int) -> list[str]:
    """Ask for a real-time priority and locked memory, and stop the garbage collector.

    What the system refuses is said and done without.

    Parameters
    ----------
    priority : int
        Of SCHED_FIFO, 1 to 99; 0 asks for nothing but the garbage collector.

    Returns
    -------
    list of str
        A line for each thing that was asked for.
    """
    gc.collect()
    gc.freeze()
    gc.disable()
    if not priority:
        return []
    return [_priority(priority), _memory()]


def _priority(priority: int) -> str:
    if not hasattr(os, "sched_setscheduler"):
        return "no real-time priority: this system has no SCHED_FIFO; going on without"
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except OSError as error:
        return (
            f"no real-time priority ({error.strerror}); going on without. To grant it, add "
            f"'@realtime - rtprio {priority}' to /etc/security/limits.conf and join that group"
        )
    return f"real-time priority {priority}"


def _memory() -> str:
    try:
        library = ctypes.CDLL(None, use_errno=True)
        failed = library.mlockall(_MCL_CURRENT | _MCL_FUTURE)
    except (OSError, AttributeError, TypeError):
        return "memory not locked: this system has no mlockall; going on without"
    if failed:
        return (
            f"memory not locked ({os.strerror(ctypes.get_errno())}); going on without. To grant "
            "it, add '@realtime - memlock unlimited' to /etc/security/limits.conf"
        )
    return "memory locked"
