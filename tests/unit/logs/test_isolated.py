import ctypes
import time

import numpy as np
import pytest

from fprc.errors import LogError
from fprc.logs.columns import read_columns
from fprc.logs.isolated import isolated


def test_result_is_that_of_the_function():
    table = np.arange(6.0).reshape(2, 3)
    assert np.array_equal(isolated(np.transpose, table, what="x"), table.T)
    assert isolated(sorted, [3, 1, 2], what="x", reverse=True) == [3, 2, 1]


def test_what_is_printed_is_no_part_of_the_result():
    assert isolated(print, "noise", what="x") is None


def test_error_of_the_function_is_raised(tmp_path):
    path = tmp_path / "absent.h5"
    with pytest.raises(LogError, match=r"absent\.h5: cannot be opened"):
        isolated(read_columns, path, (), what=str(path))
    with pytest.raises(ZeroDivisionError):
        isolated(divmod, 1, 0, what="x")


def test_function_that_hangs_is_ended_and_the_file_named():
    with pytest.raises(LogError, match=r"my\.h5: not read within 0\.2 s"):
        isolated(time.sleep, 60.0, what="my.h5", limit_s=0.2)


def test_function_that_crashes_is_told_and_the_file_named():
    with pytest.raises(LogError, match=r"my\.h5: cannot be read \(the library crashed\)"):
        isolated(ctypes.string_at, 0, what="my.h5")


def test_function_that_asks_for_too_much_memory_is_ended_and_the_file_named():
    with pytest.raises(LogError, match=r"my\.h5: reading it takes more than 4096 MB"):
        isolated(np.ones, 1 << 32, what="my.h5")
