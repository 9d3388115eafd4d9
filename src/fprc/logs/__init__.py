"""Experiment logs: HDF5 files of named channels with units."""

from fprc.logs.columns import Columns, read_columns, write_columns
from fprc.logs.holdings import COMPLETE, Holding, holdings
from fprc.logs.quality import assess
from fprc.logs.raw import RAW_CHANNELS, read_raw, read_run, refuse_to_overwrite, write_raw

__all__ = [
    "COMPLETE",
    "RAW_CHANNELS",
    "Columns",
    "Holding",
    "assess",
    "holdings",
    "read_columns",
    "read_raw",
    "read_run",
    "refuse_to_overwrite",
    "write_columns",
    "write_raw",
]
