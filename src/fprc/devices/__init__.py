"""Interface to a rig, simulated or real."""

from fprc.devices.protocol import Clock, Device

__all__ = ["Clock", "Device"]
