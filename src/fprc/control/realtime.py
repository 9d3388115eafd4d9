"""Request real-time scheduling and locked memory from the operating system."""

import ctypes
import gc
import os

_MCL_CURRENT, _MCL_FUTURE = 1, 2


def request_realtime(priority: int) -> list[str]:
    """Request a real-time priority and locked memory, and disable the garbage collector.

    A request that the system refuses is reported and otherwise ignored.

    Parameters
    ----------
    priority : int
        SCHED_FIFO priority, 1 to 99; 0 only disables the garbage collector.

    Returns
    -------
    list of str
        One line per request.
    """
    gc.collect()
    gc.freeze()
    gc.disable()
    if not priority:
        return []
    return [_priority(priority), _memory()]


def _priority(priority: int) -> str:
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except OSError as error:
        return (
            f"no real-time priority ({error.strerror}); continuing without. To grant it, add "
            f"'@realtime - rtprio {priority}' to /etc/security/limits.conf and join that group"
        )
    return f"real-time priority {priority}"


def _memory() -> str:
    if ctypes.CDLL(None, use_errno=True).mlockall(_MCL_CURRENT | _MCL_FUTURE):
        return (
            f"memory not locked ({os.strerror(ctypes.get_errno())}); continuing without. To grant "
            "it, add '@realtime - memlock unlimited' to /etc/security/limits.conf"
        )
    return "memory locked"
