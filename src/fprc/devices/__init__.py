"""Interface to a rig, simulated or real."""

from fprc.devices.protocol import NEUTRAL_V, Clock, Device

__all__ = ["NEUTRAL_V", "Clock", "Device"]
