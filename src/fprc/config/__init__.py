"""Typed settings, from which defaults, limits and reference page follow."""

from fprc.config.load import PUBLISHED, check, from_files, local_files, rig_file, rig_files
from fprc.config.settings import Settings

__all__ = ["PUBLISHED", "Settings", "check", "from_files", "local_files", "rig_file", "rig_files"]
