"""What runs on the computer at every sample."""

from fprc.control.hysteresis import hysteresis_law
from fprc.control.loop import run
from fprc.control.pressure import PressurePI

__all__ = ["PressurePI", "hysteresis_law", "run"]
