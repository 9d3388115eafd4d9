"""Request real-time scheduling and locked memory from the operating system."""

import ctypes
import gc
import os

from fprc.escape import in_words

_MCL_CURRENT, _MCL_FUTURE = 1, 2


def request_realtime(priority: int) -> str:
    """Request a real-time priority and locked memory, and disable the garbage collector.

    Parameters
    ----------
    priority : int
        SCHED_FIFO priority, 1 to 99; 0 only disables the garbage collector.

    Returns
    -------
    str
        What the system refused, which is otherwise ignored, and how to grant it; or nothing.
    """
    gc.collect()
    gc.freeze()
    gc.disable()
    refused = []
    if priority:
        try:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
        except OSError as error:
            refused.append(f"real-time priority ({error.strerror})")
        if ctypes.CDLL(None, use_errno=True).mlockall(_MCL_CURRENT | _MCL_FUTURE):
            refused.append(f"locked memory ({os.strerror(ctypes.get_errno())})")
    if not refused:
        return ""
    return (
        f"continuing without {in_words(refused)}. To grant both, add '@realtime - rtprio "
        f"{priority}' and '@realtime - memlock unlimited' to /etc/security/limits.conf, and join "
        "that group"
    )
