"""Experiment logs: HDF5 files of named channels with units."""

from fprc.logs.columns import Columns, read_columns, write_columns
from fprc.logs.quality import assess
from fprc.logs.raw import RAW_CHANNELS, read_raw, refuse_to_overwrite, write_raw

__all__ = [
    "RAW_CHANNELS",
    "Columns",
    "assess",
    "read_columns",
    "read_raw",
    "refuse_to_overwrite",
    "write_columns",
    "write_raw",
]
