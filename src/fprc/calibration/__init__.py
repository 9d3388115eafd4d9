"""Fitting the simulated rig to published numbers, in the open."""

from fprc.calibration.objective import Aim, loss_of, properties, residuals
from fprc.calibration.search import search
from fprc.calibration.space import Free, decode, encode
from fprc.calibration.surrogate import surrogate_errors

__all__ = [
    "Free",
    "Aim",
    "decode",
    "encode",
    "loss_of",
    "properties",
    "residuals",
    "search",
    "surrogate_errors",
]
