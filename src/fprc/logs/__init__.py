"""Experiment logs: HDF5 files of named channels with units."""

from fprc.logs.columns import Columns, read_columns, write_columns
from fprc.logs.quality import assess
from fprc.logs.raw import read_raw, read_run, write_raw

__all__ = [
    "Columns",
    "assess",
    "read_columns",
    "read_raw",
    "read_run",
    "write_columns",
    "write_raw",
]
