"""Tables in NumPy, Excel, TDMS and Parquet files."""

from collections.abc import Iterator
from datetime import date, time
from pathlib import Path
from typing import Any

import numpy as np

from fprc.errors import LogError
from fprc.recordings.grid import columns_of, locate
from fprc.recordings.table import Column, Table, gathered, spread

_Parts = Iterator[tuple[str, Column | str]]


def read_npz(path: Path) -> Table:
    """Read the arrays of an .npz file; an array of texts names the columns of a matrix."""
    with np.load(path) as content:
        arrays = {name: content[name] for name in content}
    texts = [array.tolist() for array in arrays.values() if array.dtype.kind == "U" and array.ndim]
    return gathered(path, "NumPy", _of_arrays(arrays, texts))


def read_npy(path: Path) -> Table:
    """Read an .npy file: a matrix, or a structured array, whose fields are columns."""
    return gathered(path, "NumPy", _of_arrays({"data": np.load(path)}, []))


def _of_arrays(arrays: dict[str, np.ndarray], texts: list[list[str]]) -> _Parts:
    for name, array in arrays.items():
        for field in array.dtype.names or ():
            yield field, Column(array[field])
        if array.dtype.names is None:
            names = next((names for names in texts if len(names) in array.shape[:2]), None)
            for part, values in spread(name, array, names).items() if names else ((name, array),):
                yield part, Column(values)


def read_xlsx(path: Path) -> Table:
    """Read the sheet of an Excel file that has the most rows, with values as they were saved."""
    from openpyxl import load_workbook

    with path.open("rb") as file:
        sheets = {
            sheet.title: {
                number: [_cell(cell) for cell in row]
                for number, row in enumerate(sheet.iter_rows(values_only=True), 1)
                if any(cell is not None for cell in row)
            }
            for sheet in load_workbook(file, read_only=True, data_only=True).worksheets
        }
    title = max(sheets, key=lambda title: len(sheets[title]))
    rows = sheets[title]
    tried = {number: str(number) for number in [*rows][:300]}
    place = locate(tried, lambda number: rows[int(number)], (), None, None, ".")
    if not place.width:
        raise LogError(f"{path}: sheet {title}: has no rows of numbers")
    fitted = {number: place.fitted(row) or row[: place.width] for number, row in rows.items()}
    below = {number: row for number, row in fitted.items() if number >= place.first and any(row)}
    found = columns_of(path, place, below, ".")
    notes = (f"sheet {title} of {len(sheets)} was read",) if len(sheets) > 1 else ()
    return found._replace(kind="Excel", notes=(*notes, *found.notes))


def _cell(value: Any) -> str:
    if isinstance(value, date | time):
        return value.isoformat()
    return "" if value is None else str(value).strip()


def read_tdms(path: Path) -> Table:
    """Read a TDMS file of LabVIEW; the clock of a channel is ``group/channel.time``, in s."""
    from nptdms import TdmsFile

    def parts() -> _Parts:
        for group in TdmsFile.read(path).groups():
            for channel in group.channels():
                name, properties = f"{group.name}/{channel.name}", channel.properties
                unit = properties.get("unit_string") or properties.get("NI_UnitDescription") or ""
                if "wf_increment" in properties and len(channel):
                    yield f"{name}.time", Column(channel.time_track(), "s")
                yield name, Column(channel[:], str(unit))

    return gathered(path, "TDMS", parts())


def read_parquet(path: Path) -> Table:
    """Read a Parquet file; the unit of a column is in its metadata as ``unit`` or ``units``."""
    from pyarrow import parquet

    table = parquet.read_table(path)

    def parts() -> _Parts:
        for name, column in zip(table.column_names, table.columns, strict=True):
            metadata = table.schema.field(name).metadata or {}
            unit = metadata.get(b"unit") or metadata.get(b"units") or b""
            yield name, Column(column.to_numpy(), unit.decode())

    return gathered(path, "Parquet", parts())
