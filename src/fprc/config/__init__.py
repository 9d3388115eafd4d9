"""Typed settings: one model gives defaults, limits, schema and reference page."""

from fprc.config.load import check, from_files
from fprc.config.settings import Settings

__all__ = ["Settings", "check", "from_files"]
