import re

import h5py
import numpy as np
import pytest

from fprc.errors import LogError
from fprc.logs import sources
from fprc.logs.arrays import read_arrays
from fprc.logs.isolated import attempt_each
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


@pytest.mark.parametrize("name", ["log.h5", "log.mat"])
def test_arrays_are_read_in_another_process(tmp_path, monkeypatch, name):
    monkeypatch.setattr(sources, "isolated_each", lambda *call, **more: ["read there"])
    (tmp_path / name).touch()
    assert read_source(tmp_path / name) == "read there"


@pytest.mark.slow
def test_file_cut_anywhere_is_refused_with_a_message_and_never_hangs(written):
    whole, cuts = written.read_bytes(), []
    for size in sorted({128, *range(0, len(whole), max(len(whole) // 60, 1))}):
        cuts.append(written.with_stem(f"cut_{size}"))
        cuts[-1].write_bytes(whole[:size])
    found = attempt_each(read_arrays, cuts, matlab=written.suffix == ".mat")
    for path, error in zip(cuts, found, strict=True):
        assert isinstance(error, LogError)
        assert str(error).startswith(f"{path}: ")
        assert not re.search("not read within|crashed", str(error))


def test_unknown_ending_is_answered_by_the_known_ones(tmp_path):
    with pytest.raises(LogError, match="must be one of .csv"):
        read_source(tmp_path / "log.xlsx")


@pytest.mark.parametrize("name", ["log.h5", "log.mat"])
def test_text_under_another_ending_is_refused(tmp_path, name):
    (tmp_path / name).write_text("t,angle\n0,1\n")
    with pytest.raises(LogError) as caught:
        read_arrays(tmp_path / name, matlab=name.endswith("mat"))
    assert str(caught.value).startswith(str(tmp_path / name))
