"""Feedforward hysteresis compensation by pneumatic physical reservoir computing."""

from importlib import import_module

__version__ = "0.1.0"


def __getattr__(name: str) -> object:
    """Import ``fprc.capacity`` when it is first asked for: the command line starts without it."""
    if name == "capacity":
        return import_module("fprc.evaluation.capacity").capacity
    raise AttributeError(f"module 'fprc' has no attribute {name!r}")
