"""Typed settings, from which defaults, limits and reference page follow."""

from fprc.config.load import check, from_files, rig_file, rig_files
from fprc.config.settings import Settings
from fprc.paper import PUBLISHED

__all__ = ["PUBLISHED", "Settings", "check", "from_files", "rig_file", "rig_files"]
