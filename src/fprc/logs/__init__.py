"""Experiment logs: HDF5 files of named channels with units."""

from fprc.logs.columns import Columns, read_columns, write_columns
from fprc.logs.journal import Journal
from fprc.logs.quality import assess
from fprc.logs.raw import read_raw, read_run, write_raw
from fprc.logs.recovery import read_journal, recover

__all__ = [
    "Columns",
    "Journal",
    "assess",
    "read_columns",
    "read_journal",
    "read_raw",
    "read_run",
    "recover",
    "write_columns",
    "write_raw",
]
