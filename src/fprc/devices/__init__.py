"""Interface to a rig, simulated or real."""

from fprc.devices.protocol import HIGHEST_V, NEUTRAL_V, Clock, Device

__all__ = ["HIGHEST_V", "NEUTRAL_V", "Clock", "Device"]
