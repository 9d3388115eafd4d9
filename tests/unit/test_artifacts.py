import errno
import os
import subprocess
import sys
from contextlib import nullcontext

import numpy as np
import pandas as pd
import pytest

from fprc.artifacts import refuse_output, replacing, write_csv, write_json, write_text
from fprc.errors import FprcError
from fprc.given import read_json


def names(folder):
    return sorted(path.name for path in folder.iterdir())


TOO_LARGE = OSError(errno.EFBIG, "File too large")


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, TOO_LARGE, None])
def test_file_is_replaced_whole_or_not_at_all(tmp_path, monkeypatch, error):
    synced = []
    monkeypatch.setattr(os, "fsync", synced.append)
    path = tmp_path / "a.b.png"
    path.write_text("old")
    raised = FprcError if error is TOO_LARGE else error
    with pytest.raises(raised) if error else nullcontext(), replacing(path) as temporary:
        temporary.write_text("new")
        if error:
            raise error
    assert names(tmp_path) == ["a.b.png"]
    assert path.read_text() == ("old" if error else "new")
    assert len(synced) == (not error)


def test_process_that_dies_while_writing_leaves_the_old_file(tmp_path):
    target = tmp_path / "table.csv"
    target.write_text("old")
    code = (
        "import os, sys\n"
        "from fprc.artifacts import replacing\n"
        "with replacing(sys.argv[1]) as temporary:\n"
        "    temporary.write_text('half')\n"
        "    os._exit(9)\n"
    )
    died = subprocess.run([sys.executable, "-c", code, str(target)], timeout=60, check=False)
    assert died.returncode == 9
    assert target.read_text() == "old"
    assert len(names(tmp_path)) == 2
    write_text(target, "new")
    assert target.read_text() == "new"
    assert names(tmp_path) == ["table.csv"]


@pytest.mark.parametrize("value", [float("nan"), float("inf"), [1.0, float("-inf")]])
def test_json_that_no_reader_takes_is_refused(tmp_path, value):
    write_json(tmp_path / "a.json", {"x": 1.0})
    with pytest.raises(ValueError, match="Out of range"):
        write_json(tmp_path / "a.json", {"x": value})
    assert read_json(tmp_path / "a.json") == {"x": 1.0}


@pytest.mark.parametrize(
    "content",
    [b"", b'{"x": 1', b"[]", b"\xff\xfe", b"[" * 100_000, b"9" * 5000, b'{"x": 1} {}'],
    ids=lambda content: repr(content[:20]),
)  # fmt: skip
def test_damaged_json_is_an_error_that_names_the_file(tmp_path, content):
    (tmp_path / "a.json").write_bytes(content)
    with pytest.raises(FprcError, match=r"a\.json: "):
        read_json(tmp_path / "a.json")


def test_table_has_six_significant_digits_and_empty_cells_where_nothing_is_known(tmp_path):
    table = pd.DataFrame({"name": ["a", "b"], "x": [1.23456789e-5, np.nan], "n": [1, 2]})
    write_csv(tmp_path / "a.csv", table)
    assert (tmp_path / "a.csv").read_text() == "name,x,n\na,1.23457e-05,1\nb,,2\n"


@pytest.mark.parametrize(
    "out",
    ["a.csv", "", ".h5", "old.h5",
     "link.h5", "folder.h5", "old.h5/a.h5", "old.h5/none/a.h5", "/proc/none/a.h5"],
    ids=lambda out: out[-8:],
)  # fmt: skip
def test_output_that_cannot_be_written_is_refused_before(out, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "old.h5").write_text("old")
    (tmp_path / "folder.h5").mkdir()
    (tmp_path / "link.h5").symlink_to("link.h5")
    before = names(tmp_path)
    with pytest.raises(FprcError):
        refuse_output(out, ".h5")
    assert names(tmp_path) == before
