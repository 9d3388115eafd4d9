"""Typed settings: one model gives defaults, limits, schema and reference page."""

from fprc.config.load import PUBLISHED, check, from_files, local_files, rig_file, rig_files
from fprc.config.settings import Settings

__all__ = [
    "PUBLISHED",
    "Settings",
    "check",
    "from_files",
    "local_files",
    "rig_file",
    "rig_files",
]
