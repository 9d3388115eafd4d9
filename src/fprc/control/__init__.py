"""Controllers and the sampled control loop."""

from fprc.control.loop import Law, RunAbortedError, hysteresis_law, run
from fprc.control.pd import PD
from fprc.control.tracking import refuse_impossible, tracking_law

__all__ = [
    "PD",
    "RunAbortedError",
    "Law",
    "hysteresis_law",
    "refuse_impossible",
    "run",
    "tracking_law",
]
