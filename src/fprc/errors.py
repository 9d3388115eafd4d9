"""Exceptions whose messages say what is wrong, where, and what to do; printed without traceback."""

from collections.abc import Collection
from typing import Self

from fprc.escape import visible


class FprcError(Exception):
    """Base class of the errors that this package raises on purpose.

    Messages may quote names of files and columns; unprintable characters in them are escaped.
    """

    def __str__(self) -> str:
        """Return the message, with unprintable characters escaped."""
        return visible(super().__str__(), kept="\n\t")


class ConfigError(FprcError):
    """The configuration has unknown keys or values out of range, or options do not go together."""

    @classmethod
    def listing(cls, problems: Collection[str], where: str, *, file: object = "") -> Self:
        """Return the error that lists all problems; it begins with the file if there is one."""
        noun = "error" if len(problems) == 1 else "errors"
        head = f"{f'{file}: ' if file else ''}{len(problems)} {noun} in the {where}:"
        return cls("\n  ".join([head, *problems]))


class LogError(FprcError):
    """A log cannot be used; the message names file, channel and sample."""


class ControlError(FprcError):
    """A run on the rig was refused, or stopped, as by a safety limit; the rig is made safe."""


class EvaluationError(FprcError):
    """Models cannot be evaluated on this data with these settings."""


class DeviceError(FprcError):
    """Hardware or its driver failed; the message names the part and what to check."""


def in_one_line(error: Exception) -> str:
    """Return the message of an error without line breaks."""
    return " ".join(str(error).split())
