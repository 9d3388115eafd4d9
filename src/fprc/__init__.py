"""Feedforward hysteresis compensation by pneumatic physical reservoir computing."""

__version__ = "0.1.0"
