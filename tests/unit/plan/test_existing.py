"""The raw logs that exist when the workflow begins."""

import h5py
import pytest

from fprc.config import check
from fprc.errors import LogError
from fprc.plan.plan import read_plan

NAMES = ["sweep", "complex", "track_sweep_fprc"]


def there(folder, source="sim"):
    settings = check({"source": source})
    return read_plan(settings, str(folder)).existing


def test_every_file_that_cannot_be_read_is_named(write_log, tmp_path):
    (tmp_path / "sweep.h5").write_bytes(b"no log at all")
    write_log("complex.h5", notes="{")
    write_log("track_sweep_fprc.h5")
    with pytest.raises(LogError) as caught:
        there(tmp_path)
    first, second = str(caught.value).splitlines()
    assert first.startswith(f"{tmp_path / 'sweep.h5'}: not a log in HDF5")
    assert second.startswith(f"{tmp_path / 'complex.h5'}: attribute notes: must be a JSON")


def test_logs_are_listed_in_the_order_of_the_plan(write_log, tmp_path):
    assert there(tmp_path) == {}
    for name in reversed(NAMES):
        write_log(f"{name}.h5")
    assert list(there(tmp_path)) == NAMES


@pytest.mark.parametrize(
    ("source", "of_log", "refused"),
    [("sim", "sim", False), ("rig", "sim", True), ("sim", "rig", True), ("sim", "import", True),
     ("sim", None, True), ("rig", None, False), ("rig", "rig", False), ("recorded", "sim", False)],
)  # fmt: skip
def test_log_of_another_source_is_not_overwritten(write_log, tmp_path, source, of_log, refused):
    paths = [write_log(f"{name}.h5", source=of_log or "sim") for name in ("sweep", "complex")]
    for path in paths if of_log is None else ():
        with h5py.File(path, "r+") as file:
            del file.attrs["source"]
    if not refused:
        assert list(there(tmp_path, source)) == ["sweep", "complex"]
        return
    with pytest.raises(LogError) as caught:
        there(tmp_path, source)
    lines = str(caught.value).splitlines()
    assert [line.split(": ")[0] for line in lines] == [str(path) for path in paths]
