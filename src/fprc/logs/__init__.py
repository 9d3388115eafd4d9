"""Experiment logs: HDF5 files of named channels with units."""

from fprc.logs.columns import Columns, read_columns, write_columns
from fprc.logs.journal import Journal
from fprc.logs.quality import assess
from fprc.logs.raw import RAW_CHANNELS, read_raw, refuse_to_overwrite, write_raw
from fprc.logs.recovery import read_journal, recover

__all__ = [
    "RAW_CHANNELS",
    "Columns",
    "Journal",
    "assess",
    "read_columns",
    "read_journal",
    "read_raw",
    "recover",
    "refuse_to_overwrite",
    "write_columns",
    "write_raw",
]
