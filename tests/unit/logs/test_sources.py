import subprocess
import sys

import h5py
import numpy as np
import pytest

from fprc.errors import LogError
from fprc.logs import sources
from fprc.logs.sources import read_source

COLUMNS = {"t": np.arange(50) / 100.0, "force": np.arange(50.0) ** 2}


@pytest.fixture(params=["hdf5", "matlab5", "matlab73"])
def written(request, tmp_path, matlab_files):
    """File of two columns."""
    if request.param == "hdf5":
        with h5py.File(tmp_path / "log.h5", "w") as file:
            file.update(COLUMNS)
        return tmp_path / "log.h5"
    getattr(matlab_files, f"write_{request.param}")(tmp_path / "log.mat", COLUMNS)
    return tmp_path / "log.mat"


@pytest.mark.slow
def test_arrays_come_out_of_the_other_process_as_they_were(written):
    found = read_source(written).variables
    assert {column: values.tolist() for column, values in found.items()} == {
        column: values.tolist() for column, values in COLUMNS.items()
    }


@pytest.mark.parametrize("name", ["log.h5", "log.mat"])
def test_arrays_are_read_in_another_process(tmp_path, monkeypatch, name):
    monkeypatch.setattr(sources, "isolated_each", lambda *call, **more: ["read there"])
    (tmp_path / name).touch()
    assert read_source(tmp_path / name) == "read there"


READ_DAMAGED = """
import sys
from pathlib import Path
from fprc.errors import LogError
from fprc.logs.arrays import read_arrays

path = Path(sys.argv[1])
whole = path.read_bytes()
damaged = path.with_stem("damaged")
for cut in sorted({128, *range(0, len(whole), max(len(whole) // 60, 1))}):
    damaged.write_bytes(whole[:cut])
    try:
        read_arrays(damaged, matlab=path.suffix == ".mat")
    except LogError as error:
        print("LogError" if str(error).startswith(str(damaged)) else str(error))
    except BaseException as error:
        print(cut, type(error).__name__, error)
    else:
        print("read")
"""


@pytest.mark.slow
def test_file_cut_anywhere_is_refused_with_a_message_and_never_hangs(written):
    run = subprocess.run(
        [sys.executable, "-c", READ_DAMAGED, str(written)],
        capture_output=True, text=True, timeout=60, check=True,
    )  # fmt: skip
    assert set(run.stdout.splitlines()) == {"LogError"}


READ_AND_MEASURE = """
import resource, sys
from fprc.logs.sources import read_source

print(read_source(sys.argv[1]).others["x"])
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""


@pytest.mark.slow
def test_small_file_of_a_billion_numbers_is_refused_in_little_memory(tmp_path):
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("x", shape=(10**9,), dtype="f8", chunks=(10**6,), compression=1)
    assert path.stat().st_size < 10 << 20
    # In a process of its own: the peak of a process's children covers all that it ever started.
    command = [sys.executable, "-c", READ_AND_MEASURE, str(path)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    answer, peak_kib = run.stdout.splitlines()
    assert "1,000,000,000 numbers" in answer
    assert int(peak_kib) < 1 << 20


def test_unknown_ending_is_answered_by_the_known_ones(tmp_path):
    with pytest.raises(LogError, match="must be one of .csv"):
        read_source(tmp_path / "log.xlsx")


@pytest.mark.parametrize("name", ["log.h5", "log.mat"])
def test_text_under_another_ending_is_refused(tmp_path, name):
    (tmp_path / name).write_text("t,angle\n0,1\n")
    with pytest.raises(LogError) as caught:
        sources.read_arrays(tmp_path / name, matlab=name.endswith("mat"))
    assert str(caught.value).startswith(str(tmp_path / name))
