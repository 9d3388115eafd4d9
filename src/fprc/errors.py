"""Exceptions that are meant to be read by a person.

Each message says what is wrong, where, and what to do about it. The command
line and the workflow print the message alone, without a traceback.
"""

from fprc.escape import terminal


class FprcError(Exception):
    """Base of every error that this package raises on purpose.

    What a message quotes of a file cannot command the terminal.
    """

    def __str__(self) -> str:
        """Return the message; its lines have no control characters."""
        return terminal(super().__str__())


class ConfigError(FprcError):
    """The configuration holds unknown keys or values out of range."""


class LogError(FprcError):
    """A log cannot be used; the message names file, channel and sample."""


class SimulationError(FprcError):
    """The simulated rig left the range in which its physics means anything."""


class ControlError(FprcError):
    """A run on the rig was refused or stopped; the rig is in its safe state."""


class EvaluationError(FprcError):
    """Models cannot be judged on this data with these settings."""


class DeviceError(FprcError):
    """Hardware or its driver failed; the message names the part and what to check."""


class SafetyError(ControlError):
    """A reading or a command left what the rig may do."""


class OutputError(FprcError):
    """A result cannot be written."""
