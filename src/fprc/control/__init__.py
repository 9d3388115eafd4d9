"""Controllers and the sampled control loop."""

from fprc.control.loop import Law, RunAbortedError, hysteresis_law, run
from fprc.control.pd import PD
from fprc.control.pressure import PressurePI, pressure_loops
from fprc.control.tracking import feedforward, refuse_impossible, tracking_law

__all__ = [
    "PD",
    "RunAbortedError",
    "Law",
    "PressurePI",
    "feedforward",
    "hysteresis_law",
    "pressure_loops",
    "refuse_impossible",
    "run",
    "tracking_law",
]
